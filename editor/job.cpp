#include "job.hpp"

#include <utility>

namespace editor {

Job::~Job() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

void Job::start(std::string name, std::function<void(tri::Context&)> work) {
  name_ = std::move(name);
  progress_ = {name_, 0};
  error_ = nullptr;
  done_ = false;
  context_ = std::make_unique<tri::Context>();
  context_->on_progress = [this](std::string_view step, double share) {
    const std::lock_guard lock(mutex_);
    progress_ = {std::string(step), static_cast<float>(share)};
  };
  thread_ = std::thread([this, work = std::move(work)] {
    try {
      work(*context_);
    } catch (...) {
      error_ = std::current_exception();
    }
    done_.store(true, std::memory_order_release);
  });
}

void Job::cancel() {
  if (context_) context_->cancel();
}

Job::Progress Job::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

void Job::finish() {
  thread_.join();
  context_.reset();
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

}  // namespace editor
