#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "io/plugins.hpp"
#include "meshops/error.hpp"
#include "meshops/pipeline.hpp"
#include "meshops/plugin.hpp"
#include "temporary_folder.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

const std::string folder = TRI_TEST_PLUGINS;

template <class Exception>
std::string message_of(const std::string& path, Registry& registry) {
  try {
    load_plugin(registry, path);
  } catch (const Exception& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("plugins: the operators of a plug-in stand among the others, in the registry it was loaded into only") {
  Registry registry = Registry::standard();
  const Plugin plugin = load_plugin(registry, folder + "/good/scale.so");
  CHECK(plugin.name == "scaling");
  CHECK(plugin.version == "1.0");
  CHECK(plugin.operators == std::vector<std::string>{"scale"});
  CHECK(registry.operators().size() == Registry::standard().operators().size() + 1);
  CHECK(Registry::standard().find("scale") == nullptr);
  CHECK(registry.at("scale").schema().find("factor") != nullptr);

  Mesh mesh = icosahedron();
  const Mesh before = mesh;
  Context context;
  Pipeline pipeline(registry);
  pipeline.add("scale", {{"factor", 4}}).add("compact");
  const auto reports = pipeline.run(view_of(mesh), context);
  CHECK(reports[0].vertices_moved == mesh.n_vertices());
  for (const VertexHandle v : mesh.vertices()) CHECK(mesh.point(v) == before.point(v) * 4.0);
  CHECK_THROWS_AS(pipeline.add("scale", {{"factor", 0}}), InvalidInput);
}

TEST_CASE("plugins: the code stays as long as a copy of the registry lives") {
  auto first = std::make_unique<Registry>(Registry::standard());
  load_plugin(*first, folder + "/good/scale.so");
  Registry copy = *first;
  first.reset();
  Mesh mesh = icosahedron();
  Context context;
  CHECK(copy.at("scale").run(view_of(mesh), copy.at("scale").schema().make().get(), context).unchanged());
  copy = Registry::standard();  // releases the plug-in
  CHECK(copy.find("scale") == nullptr);
  load_plugin(copy, folder + "/good/scale.so");
  CHECK(copy.find("scale") != nullptr);
}

TEST_CASE("plugins: loaded at the same time on several threads, each into a registry of its own") {
  std::vector<int> failed(3, 0);
  std::vector<std::thread> threads;
  for (int& result : failed)
    threads.emplace_back([&result] {
      for (int round = 0; round < 3; ++round) {
        Registry registry = Registry::standard();
        load_plugin(registry, folder + "/good/scale.so");
        Mesh mesh = icosahedron();
        Context context;
        const auto options = registry.at("scale").schema().make();
        result += !registry.at("scale").run(view_of(mesh), options.get(), context).unchanged();
      }
    });
  for (std::thread& t : threads) t.join();
  for (const int result : failed) CHECK(result == 0);
}

TEST_CASE("plugins: what an operator of a plug-in throws arrives as the library's own exceptions") {
  Registry registry = Registry::standard();
  load_plugin(registry, folder + "/good/scale.so");
  Mesh mesh = icosahedron();
  Context context;
  context.cancel();
  const auto options = registry.at("scale").schema().make();
  CHECK_THROWS_AS(registry.at("scale").run(view_of(mesh), options.get(), context), Cancelled);
}

TEST_CASE("plugins: one that was built with something else is refused, with both named, before its code runs") {
  Registry registry = Registry::standard();
  const std::string message = message_of<IoError>(folder + "/foreign/foreign.so", registry);
  CAPTURE(message);
  CHECK(contains(message, "foreign.so: this plug-in was built with tri 0.0, GCC 4"));
  CHECK(contains(message, "; here is tri 0."));
  CHECK(registry.operators().size() == Registry::standard().operators().size());
}

TEST_CASE("plugins: a name that is taken is an error that names the plug-in, and nothing of it stays") {
  Registry registry = Registry::standard();
  const std::string message = message_of<InvalidInput>(folder + "/clash/clash.so", registry);
  CAPTURE(message);
  CHECK(contains(message, "clash.so: plug-in clashing 2.1: operator compact is there already"));
  CHECK(registry.find("first-of-two") == nullptr);

  const std::vector<std::string> folders{folder + "/good", folder + "/clash"};
  CHECK_THROWS_AS(load_plugins(registry, folders), InvalidInput);
  CHECK(registry.find("scale") == nullptr);
}

TEST_CASE("plugins: what is no plug-in is refused, and a folder without any is fine") {
  const TemporaryFolder empty;
  Registry registry = Registry::standard();
  CHECK(load_plugins(registry, std::vector<std::string>{empty.path()}).empty());
  empty.make("notes.txt", "not looked at");
  CHECK(load_plugins(registry, std::vector<std::string>{empty.path()}).empty());
  const std::string text = empty.make("text.so", "hello");
  CHECK(contains(message_of<IoError>(text, registry), "text.so: is no plug-in of tri"));
  CHECK(contains(message_of<IoError>(empty / "none.so", registry), "none.so: there is no such file"));
  const std::vector<std::string> missing{empty / "missing"};
  CHECK_THROWS_AS(load_plugins(registry, missing), IoError);

  // It says the right thing and cannot be loaded.
  const std::string fake = empty.make("fake.so", "tri plug-in {" TRI_PLUGIN_INTERFACE "}");
  CHECK(contains(message_of<IoError>(fake, registry), "fake.so: cannot be loaded: "));
}

TEST_CASE("plugins: a list of folders is separated by colons") {
  CHECK(plugin_folders("").empty());
  CHECK(plugin_folders("/a") == std::vector<std::string>{"/a"});
  CHECK(plugin_folders(":/a b::c/d:") == std::vector<std::string>{"/a b", "c/d"});
}
