"use strict";
(function () {
  const byId = (id) => document.getElementById(id);

  // Tables: a click on a head sorts by that column.
  function makeSortable(table) {
    const heads = Array.from(table.querySelectorAll("th"));
    const body = table.tBodies[0];
    heads.forEach(function (head, column) {
      head.addEventListener("click", function () {
        const down = head.getAttribute("aria-sort") !== "descending";
        const number = head.classList.contains("number");
        const key = function (row) {
          const text = row.cells[column].textContent;
          if (!number) return text;
          const value = parseFloat(text.replace(/[, %]/g, ""));
          return isNaN(value) ? null : value;
        };
        const rows = Array.from(body.rows).map((row) => [key(row), row]);
        rows.sort(function (a, b) {
          if (a[0] === null || b[0] === null) return (a[0] === null) - (b[0] === null);
          const order = number ? a[0] - b[0] : a[0].localeCompare(b[0]);
          return down ? -order : order;
        });
        heads.forEach((other) => other.setAttribute("aria-sort", "none"));
        head.setAttribute("aria-sort", down ? "descending" : "ascending");
        rows.forEach((pair) => body.appendChild(pair[1]));
      });
    });
  }
  document.body.classList.add("live-tables");
  document.querySelectorAll("table.sortable").forEach(makeSortable);

  if (typeof THREE === "undefined") return;
  const data = JSON.parse(byId("scene").textContent);

  function bytesOf(base64) {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
  }
  const low = new THREE.Vector3().fromArray(data.low);
  const high = new THREE.Vector3().fromArray(data.high);
  const middle = low.clone().add(high).multiplyScalar(0.5);
  const radius = Math.max(0.5 * high.distanceTo(low), 1e-9);

  // Places relative to the middle, so that single precision is enough far from the origin, too.
  function positionsOf(part) {
    const packed = new Uint16Array(bytesOf(part.positions).buffer);
    const positions = new Float32Array(packed.length);
    const offset = [low.x - middle.x, low.y - middle.y, low.z - middle.z];
    const step = [(high.x - low.x) / 65535, (high.y - low.y) / 65535, (high.z - low.z) / 65535];
    for (let i = 0; i < packed.length; ++i) positions[i] = offset[i % 3] + step[i % 3] * packed[i];
    return positions;
  }
  function geometryOf(part) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positionsOf(part), 3));
    if (part.indices) {
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytesOf(part.indices).buffer), 1));
      geometry.computeVertexNormals();
    }
    const deviation = part.deviation ? new Float32Array(bytesOf(part.deviation).buffer) : new Float32Array(part.vertices).fill(3e38);
    geometry.setAttribute("deviation", new THREE.BufferAttribute(deviation, 1));
    geometry.setAttribute("dim", new THREE.BufferAttribute(new Float32Array(part.vertices), 1));
    return geometry;
  }

  const renderer = (function () {
    try {
      return new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    } catch (error) {
      return null;  // the static picture stays, and the note below it
    }
  })();
  if (!renderer) return;

  const palette = bytesOf(data.palette);
  const colorAt = (i) => new THREE.Vector3(palette[3 * i] / 255, palette[3 * i + 1] / 255, palette[3 * i + 2] / 255);
  const ramp = new THREE.DataTexture(palette.slice(0, 768), 256, 1, THREE.RGBFormat);
  ramp.magFilter = ramp.minFilter = THREE.LinearFilter;
  ramp.needsUpdate = true;

  const colorSource = `
    uniform sampler2D ramp;
    uniform float scaleLow, scaleHigh;
    uniform vec3 below, above, unknown;
    vec3 colorOf(float deviation, float dim) {
      vec3 color;
      if (deviation > 1e30) color = unknown;
      else if (deviation < scaleLow) color = below;
      else if (deviation > scaleHigh) color = above;
      else color = texture2D(ramp, vec2((deviation - scaleLow) / (scaleHigh - scaleLow) * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
      return mix(color, vec3(0.86, 0.88, 0.90), 0.85 * dim);
    }`;
  const uniforms = function () {
    return {
      ramp: { value: ramp },
      scaleLow: { value: data.scaleLow },
      scaleHigh: { value: data.scaleHigh },
      below: { value: colorAt(data.tolerance ? 256 : 0) },
      above: { value: colorAt(data.tolerance ? 257 : 255) },
      unknown: { value: colorAt(258) },
      size: { value: 4 }
    };
  };
  function surfaceMaterial() {
    return new THREE.ShaderMaterial({
      uniforms: uniforms(),
      side: THREE.DoubleSide,
      extensions: { derivatives: true },
      vertexShader: `
        attribute float deviation, dim;
        varying float vDeviation, vDim;
        varying vec3 vNormal, vEye;
        void main() {
          vec4 eye = modelViewMatrix * vec4(position, 1.0);
          vDeviation = deviation;
          vDim = dim;
          vNormal = normalMatrix * normal;
          vEye = eye.xyz;
          gl_Position = projectionMatrix * eye;
        }`,
      fragmentShader: colorSource + `
        varying float vDeviation, vDim;
        varying vec3 vNormal, vEye;
        void main() {
          vec3 flatNormal = normalize(cross(dFdx(vEye), dFdy(vEye)));
          vec3 smoothNormal = normalize(vNormal);
          if (dot(smoothNormal, flatNormal) < 0.0) smoothNormal = -smoothNormal;
          // Sharp edges stay sharp: corners whose normal turns by more than 0.6 rad do not count.
          vec3 n = dot(smoothNormal, flatNormal) < 0.825 ? flatNormal : smoothNormal;
          vec3 light = normalize(vec3(-0.25, 0.35, 1.0));
          float diffuse = max(dot(n, light), 0.0);
          float gleam = pow(max(dot(n, normalize(light + vec3(0.0, 0.0, 1.0))), 0.0), 40.0);
          gl_FragColor = vec4(colorOf(vDeviation, vDim) * (0.55 + 0.50 * diffuse) + 0.07 * gleam, 1.0);
        }`
    });
  }
  function pointMaterial() {
    return new THREE.ShaderMaterial({
      uniforms: uniforms(),
      vertexShader: `
        attribute float deviation, dim;
        uniform float size;
        varying float vDeviation, vDim;
        void main() {
          vDeviation = deviation;
          vDim = dim;
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
          gl_Position.z -= 0.0013;  // 0.4% of the radius before the surface that the points lie on
          gl_PointSize = size;
        }`,
      fragmentShader: colorSource + `
        varying float vDeviation, vDim;
        void main() {
          float r = length(gl_PointCoord - 0.5);
          if (r > 0.5) discard;
          gl_FragColor = vec4(colorOf(vDeviation, vDim) * (r > 0.38 ? 0.72 : 1.0), 1.0);
        }`
    });
  }

  const world = new THREE.Scene();
  const geometry = geometryOf(data.scene);
  const isSurface = Boolean(data.scene.indices);
  const part = isSurface ? new THREE.Mesh(geometry, surfaceMaterial()) : new THREE.Points(geometry, pointMaterial());
  part.frustumCulled = false;
  world.add(part);
  let backdrop = null;
  if (data.backdrop) {
    backdrop = new THREE.Mesh(geometryOf(data.backdrop), surfaceMaterial());
    backdrop.material.uniforms.unknown.value = new THREE.Vector3(0.83, 0.85, 0.87);
    backdrop.frustumCulled = false;
    world.add(backdrop);
  }

  // The camera looks along -z of a frame that `turn` takes the part into; `shift` is what lies in the middle of the picture.
  const box = byId("canvas");
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -3 * radius, 3 * radius);
  const turn = new THREE.Quaternion();
  const shift = new THREE.Vector3();
  let zoom = 1, width = 1, height = 1;
  const legendWidth = 128;

  function lookFrom(direction, up) {
    const z = direction.clone().normalize();
    const x = new THREE.Vector3().crossVectors(up, z).normalize();
    const y = new THREE.Vector3().crossVectors(z, x);
    turn.setFromRotationMatrix(new THREE.Matrix4().makeBasis(x, y, z)).inverse();
  }
  // Shows the whole part as it is turned now.
  function fit() {
    const least = new THREE.Vector3(Infinity, Infinity, Infinity), most = least.clone().negate();
    const p = new THREE.Vector3();
    [part, backdrop].forEach(function (object) {
      if (!object) return;
      const positions = object.geometry.attributes.position.array;
      const step = 3 * Math.max(1, Math.floor(positions.length / 60000));
      for (let i = 0; i < positions.length; i += step) {
        p.set(positions[i], positions[i + 1], positions[i + 2]).applyQuaternion(turn);
        least.min(p);
        most.max(p);
      }
    });
    shift.copy(least).add(most).multiplyScalar(0.5).applyQuaternion(turn.clone().inverse());
    const wide = Math.max(most.x - least.x, 1e-9) / Math.max(width - 2 * legendWidth, 50);
    const tall = Math.max(most.y - least.y, 1e-9) / Math.max(height - 70, 50);
    zoom = 1 / Math.max(wide, tall);  // pixels a unit
  }
  const toPixels = function (local) {
    const p = local.clone().sub(shift).applyQuaternion(turn).multiplyScalar(zoom);
    return new THREE.Vector3(0.5 * width + p.x, 0.5 * height - p.y, p.z);
  };

  let waiting = false;
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(draw);
  }
  function draw() {
    waiting = false;
    camera.left = -0.5 * width / zoom;
    camera.right = 0.5 * width / zoom;
    camera.top = 0.5 * height / zoom;
    camera.bottom = -0.5 * height / zoom;
    camera.quaternion.copy(turn).inverse();
    camera.position.copy(shift);
    camera.updateProjectionMatrix();
    const ratio = renderer.getPixelRatio();
    if (!isSurface) {
      // About as wide as the points are apart, within what can be seen and does not hide the part.
      const apart = Math.sqrt(4 * radius * radius / Math.max(1, data.scene.vertices)) * zoom;
      part.material.uniforms.size.value = Math.min(9, Math.max(2.5, 0.75 * apart)) * ratio;
    }
    renderer.render(world, camera);
    placePins();
    placeProbe();
    drawTriad();
  }
  function resize() {
    width = Math.max(box.clientWidth, 1);
    height = Math.max(box.clientHeight, 1);
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    renderer.setSize(width, height, false);
    redraw();
  }

  // Pins on the worst places, and what was clicked at.
  const spots = data.spots.map(function (spot, index) {
    const pin = document.createElement("button");
    pin.type = "button";
    pin.textContent = String(index + 1);
    pin.title = spot.text;
    byId("pins").appendChild(pin);
    pin.addEventListener("click", () => chooseSpot(index, false));
    return { at: new THREE.Vector3().fromArray(spot.at).sub(middle), normal: new THREE.Vector3().fromArray(spot.normal), text: spot.text, pin: pin };
  });
  let showPins = true;
  function placePins() {
    const toward = new THREE.Vector3(0, 0, 1).applyQuaternion(turn.clone().inverse());
    spots.forEach(function (spot) {
      const p = toPixels(spot.at);
      const inside = p.x >= 0 && p.x <= width && p.y >= 0 && p.y <= height;
      spot.pin.style.display = showPins && inside ? "" : "none";
      spot.pin.style.transform = "translate(" + (p.x + 11).toFixed(1) + "px," + (p.y + 10).toFixed(1) + "px)";
      spot.pin.classList.toggle("behind", spot.normal.dot(toward) < -0.05);
    });
  }
  const probe = byId("probe");
  let probed = null;
  function placeProbe() {
    probe.hidden = !probed;
    if (!probed) return;
    const p = toPixels(probed.at);
    const left = Math.min(Math.max(p.x + 14, 4), width - probe.offsetWidth - 4);
    const top = Math.min(Math.max(p.y + 12, 4), height - probe.offsetHeight - 4);
    probe.style.transform = "translate(" + left.toFixed(1) + "px," + top.toFixed(1) + "px)";
  }
  function showProbe(at, text) {
    probed = { at: at };
    probe.textContent = text;
    redraw();
  }
  function chooseSpot(index, come) {
    spots.forEach((spot, i) => spot.pin.classList.toggle("chosen", i === index));
    document.querySelectorAll("tr[data-spot]").forEach((row) => row.classList.toggle("chosen", Number(row.dataset.spot) === index));
    const spot = spots[index];
    if (come) {
      const toward = new THREE.Vector3(0, 0, 1).applyQuaternion(turn.clone().inverse());
      if (spot.normal.lengthSq() > 0 && spot.normal.dot(toward) < 0.35) {
        const up = Math.abs(spot.normal.z) > 0.95 * spot.normal.length() ? new THREE.Vector3(0, 1, 0) : new THREE.Vector3(0, 0, 1);
        lookFrom(spot.normal.clone().normalize().add(new THREE.Vector3(-0.2, -0.3, 0.25)), up);
      }
      fit();
      zoom *= 2.2;
      shift.copy(spot.at);
    }
    showProbe(spot.at, spot.text);
  }
  document.querySelectorAll("tr[data-spot]").forEach(function (row) {
    row.addEventListener("click", () => chooseSpot(Number(row.dataset.spot), true));
  });

  // A face chosen in a table stands out, the others fade.
  const faceOf = data.scene.face ? new Int32Array(bytesOf(data.scene.face).buffer) : null;
  let chosenFace = 0;
  function chooseFace(face) {
    chosenFace = face === chosenFace ? 0 : face;
    const dim = geometry.attributes.dim;
    for (let i = 0; i < dim.count; ++i) dim.array[i] = chosenFace > 0 && faceOf[i] !== chosenFace ? 1 : 0;
    dim.needsUpdate = true;
    document.querySelectorAll("tr[data-face]").forEach((row) => row.classList.toggle("chosen", Number(row.dataset.face) === chosenFace));
    redraw();
  }
  if (faceOf)
    document.querySelectorAll("tr[data-face]").forEach(function (row) {
      row.addEventListener("click", () => chooseFace(Number(row.dataset.face)));
    });

  // The vertex that is seen at a place of the picture, or -1.
  function vertexAt(x, y) {
    const positions = geometry.attributes.position.array;
    if (isSurface) {
      const ray = new THREE.Raycaster();
      ray.setFromCamera(new THREE.Vector2(2 * x / width - 1, 1 - 2 * y / height), camera);
      const hits = ray.intersectObject(part);
      if (hits.length === 0) return -1;
      const hit = hits[0], corners = [hit.face.a, hit.face.b, hit.face.c];
      const distance = (v) => new THREE.Vector3().fromArray(positions, 3 * v).distanceToSquared(hit.point);
      return corners.sort((a, b) => distance(a) - distance(b))[0];
    }
    const p = new THREE.Vector3();
    let best = -1, nearest = Infinity;
    for (let v = 0; 3 * v < positions.length; ++v) {
      p.set(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]).sub(shift).applyQuaternion(turn).multiplyScalar(zoom);
      const away = Math.hypot(0.5 * width + p.x - x, 0.5 * height - p.y - y);
      if (away > 10) continue;
      const rank = 4 * away - p.z;  // of two points as near, the one in front
      if (rank < nearest) {
        nearest = rank;
        best = v;
      }
    }
    return best;
  }
  function probeAt(x, y) {
    const v = vertexAt(x, y);
    if (v < 0) {
      probed = null;
      redraw();
      return;
    }
    const deviation = geometry.attributes.deviation.array[v];
    const at = new THREE.Vector3().fromArray(geometry.attributes.position.array, 3 * v);
    const place = at.clone().add(middle);
    let text = deviation > 1e30 ? "no deviation" : (deviation >= 0 ? "+" : "") + deviation.toFixed(data.decimals) + " " + data.unit;
    if (faceOf && faceOf[v] > 0) text += "   face " + faceOf[v];
    text += "\n" + [place.x, place.y, place.z].map((c) => c.toPrecision(5)).join("  ");
    showProbe(at, text);
  }

  // Turning as on a ball, moving, zooming; one or two fingers do as well.
  const fingers = new Map();
  let moved = 0, button = 0;
  const rotate = function (dx, dy) {
    const angle = Math.hypot(dx, dy) * 0.0085;
    if (angle > 0) turn.premultiply(new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(dy, dx, 0).normalize(), angle));
  };
  const move = function (dx, dy) {
    shift.add(new THREE.Vector3(-dx / zoom, dy / zoom, 0).applyQuaternion(turn.clone().inverse()));
  };
  const scaleAbout = function (factor, x, y) {
    const limited = Math.min(Math.max(zoom * factor, 5 / radius), 1e5 * width / radius) / zoom;
    const dx = x - 0.5 * width, dy = y - 0.5 * height;
    move(dx * (1 / limited - 1), dy * (1 / limited - 1));
    zoom *= limited;
  };
  const canvas = renderer.domElement;
  const placeOf = function (event) {
    const frame = canvas.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top];
  };
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", function (event) {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, placeOf(event));
    if (fingers.size === 1) {
      moved = 0;
      button = event.button !== 0 || event.shiftKey ? 2 : 0;
    }
  });
  canvas.addEventListener("pointermove", function (event) {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = placeOf(event), dx = now[0] - before[0], dy = now[1] - before[1];
    moved += Math.abs(dx) + Math.abs(dy);
    if (fingers.size === 2) {
      const others = Array.from(fingers.entries()).filter((entry) => entry[0] !== event.pointerId);
      const other = others[0][1];
      const away = (p) => Math.max(Math.hypot(p[0] - other[0], p[1] - other[1]), 1);
      scaleAbout(away(now) / away(before), 0.5 * (now[0] + other[0]), 0.5 * (now[1] + other[1]));
      move(0.5 * dx, 0.5 * dy);
    } else if (button === 2) {
      move(dx, dy);
    } else {
      rotate(dx, dy);
    }
    fingers.set(event.pointerId, now);
    redraw();
  });
  const lift = function (event) {
    const alone = fingers.size === 1 && fingers.has(event.pointerId);
    fingers.delete(event.pointerId);
    if (event.type === "pointerup" && alone && moved < 4 && button === 0) probeAt.apply(null, placeOf(event));
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("wheel", function (event) {
    event.preventDefault();
    const place = placeOf(event);
    const lines = event.deltaMode === 1 ? 33 : 1;
    scaleAbout(Math.exp(-0.0015 * event.deltaY * lines), place[0], place[1]);
    redraw();
  }, { passive: false });

  const triad = byId("triad");
  const triadLines = [["x", "#c2302e"], ["y", "#2e8b3d"], ["z", "#2458b8"]].map(function (axis) {
    const make = function (name) {
      const element = document.createElementNS("http://www.w3.org/2000/svg", name);
      triad.appendChild(element);
      return element;
    };
    const line = make("line"), text = make("text");
    line.setAttribute("stroke", axis[1]);
    line.setAttribute("stroke-width", "2");
    text.setAttribute("style", "fill:" + axis[1]);
    text.textContent = axis[0];
    return [line, text];
  });
  function drawTriad() {
    [new THREE.Vector3(1, 0, 0), new THREE.Vector3(0, 1, 0), new THREE.Vector3(0, 0, 1)].forEach(function (axis, k) {
      axis.applyQuaternion(turn);
      triadLines[k][0].setAttribute("x2", (24 * axis.x).toFixed(2));
      triadLines[k][0].setAttribute("y2", (-24 * axis.y).toFixed(2));
      triadLines[k][1].setAttribute("x", (32 * axis.x).toFixed(2));
      triadLines[k][1].setAttribute("y", (-32 * axis.y + 4).toFixed(2));
    });
  }

  // Buttons.
  const zUp = new THREE.Vector3(0, 0, 1), yUp = new THREE.Vector3(0, 1, 0);
  const start = new THREE.Vector3().fromArray(data.view);
  [["Fit", null], ["Start", [start, zUp]], ["+X", [new THREE.Vector3(1, 0, 0), zUp]], ["-X", [new THREE.Vector3(-1, 0, 0), zUp]],
    ["+Y", [new THREE.Vector3(0, 1, 0), zUp]], ["-Y", [new THREE.Vector3(0, -1, 0), zUp]],
    ["+Z", [new THREE.Vector3(0, 0, 1), yUp]], ["-Z", [new THREE.Vector3(0, 0, -1), yUp]]].forEach(function (view) {
    const element = document.createElement("button");
    element.type = "button";
    element.textContent = view[0];
    element.addEventListener("click", function () {
      if (view[1]) lookFrom(view[1][0], view[1][1]);
      fit();
      redraw();
    });
    byId("views").appendChild(element);
  });
  function addSwitch(text, action) {
    const label = document.createElement("label"), check = document.createElement("input");
    check.type = "checkbox";
    check.checked = true;
    check.addEventListener("change", function () {
      action(check.checked);
      redraw();
    });
    label.appendChild(check);
    label.appendChild(document.createTextNode(" " + text));
    byId("switches").appendChild(label);
  }
  if (spots.length > 0) addSwitch("worst places", (on) => { showPins = on; });
  if (backdrop) addSwitch("CAD model", (on) => { backdrop.visible = on; });

  byId("tools").hidden = false;
  byId("viewer").classList.add("live");
  document.body.classList.add("live");
  box.insertBefore(canvas, box.firstChild);
  renderer.setClearColor(0xffffff, 0);
  lookFrom(start, zUp);
  resize();
  fit();
  window.addEventListener("resize", resize);
  redraw();
})();
