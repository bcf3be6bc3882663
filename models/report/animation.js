// The device in motion: two rigid parts whose motion is exaggerated about their rest position, elastomers between them,
// stops at their (equally exaggerated) clearance, forces on the mobile part as arrows. Lengths are drawn in units of
// the largest distance of a connection from the centre.
const wemsSensorSize = 0.055;
const wemsPinSize = 0.07, wemsPlate = 0.026, wemsLongestArrow = 0.9, wemsDisplayed = 0.16;

// Everything that is drawn, and place(pose), which moves it.
class WemsDevice {
  constructor(scene) {
    this.data = scene;
    const at = scene.connections.map(c => new THREE.Vector3(...c.at));
    this.center = at.reduce((sum, r) => sum.add(r), new THREE.Vector3()).divideScalar(at.length);
    this.size = Math.max(...at.map(r => r.distanceTo(this.center)), 1e-3);
    this.root = new THREE.Group();
    this.fixed = new THREE.Group();
    this.mobile = new THREE.Group();
    this.root.add(this.fixed, this.mobile);
    this.materials = {};
    for (const name of ["mobile", "fixed", "elastomer", "stop", "closed", "force", "sensor", "ink"])
      this.materials[name] = new THREE.MeshLambertMaterial();
    this.materials.shell = new THREE.MeshLambertMaterial({ transparent: true, opacity: 0.3, depthWrite: false });
    this.ends = at.map(r => r.clone().sub(this.center).divideScalar(this.size));
    this.addMobile();
    this.addFixed();
    this.addStops();
    this.addShapes();
    this.addSensors();
    this.arrows = this.ends.map(() => {
      const arrow = new THREE.Group();
      arrow.shaft = this.mesh(new THREE.CylinderBufferGeometry(0.017, 0.017, 1, 12), "force", arrow);
      arrow.head = this.mesh(new THREE.ConeBufferGeometry(0.05, 0.13, 16), "force", arrow);
      this.root.add(arrow);
      return arrow;
    });
    this.addScaleBar();
    const bounds = new THREE.Box3().setFromPoints([...this.posts, ...this.scaleEnds]).expandByObject(this.fixed)
      .expandByObject(this.mobile);
    this.bounds = bounds.getBoundingSphere(new THREE.Sphere());
    this.recolor();
  }

  mesh(geometry, material, group) {
    const mesh = new THREE.Mesh(geometry, this.materials[material]);
    group.add(mesh);
    return mesh;
  }

  // A rod between two points; its geometry has length 1 along y.
  static stretch(mesh, from, to) {
    const along = to.clone().sub(from);
    mesh.position.copy(from).addScaledVector(along, 0.5);
    mesh.scale.set(1, Math.max(along.length(), 1e-6), 1);
    mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
  }

  rod(radius, material, group, from, to) {
    const mesh = this.mesh(new THREE.CylinderBufferGeometry(radius, radius, 1, 16), material, group);
    if (from) WemsDevice.stretch(mesh, from, to);
    return mesh;
  }

  drawn(part) {
    return this.data.shapes.filter(shape => shape.part === part);
  }

  // Without a drawing a stand-in: arms to the connections, a body at the centre of gravity.
  addMobile() {
    const origin = new THREE.Vector3(), standIn = this.drawn("mobile").length === 0;
    for (const end of this.ends) {
      if (standIn) this.rod(0.04, "mobile", this.mobile, origin, end);
      const pin = this.mesh(new THREE.BoxBufferGeometry(2 * wemsPinSize, 2 * wemsPinSize, 2 * wemsPinSize), "mobile", this.mobile);
      pin.position.copy(end);
    }
    const cog = new THREE.Vector3(...this.data.cog).sub(this.center).divideScalar(this.size);
    const half = Math.min(0.35, Math.max(0.12, 0.6 * cog.length()));
    if (standIn) {
      if (cog.length() > 0.05) this.rod(0.06, "mobile", this.mobile, origin, cog);
      const wheel = this.mesh(new THREE.CylinderBufferGeometry(0.5, 0.5, 2 * half, 48), "shell", this.mobile);
      wheel.rotation.x = Math.PI / 2;
      wheel.position.copy(cog);
    }
    this.mesh(new THREE.SphereBufferGeometry(0.06, 24, 16), "mobile", this.mobile).position.copy(cog);
  }

  addFixed() {
    const standIn = this.drawn("fixed").length === 0;
    const base = new THREE.Vector3(0, 0, Math.min(...this.ends.map(end => end.z)) - 0.55);
    this.posts = this.ends.map(end => {
      // Beside the pin, as seen from the centre: stops are above, below and outside more often than there.
      const beside = new THREE.Vector3(-end.y, end.x, 0);
      if (beside.length() < 1e-3) beside.set(1, 0, 0);
      const top = end.clone().addScaledVector(beside.normalize(), 0.42);
      const foot = new THREE.Vector3(top.x, top.y, base.z);
      this.rod(0.035, "fixed", this.fixed, foot, new THREE.Vector3(top.x, top.y, end.z + 0.06));
      if (standIn) this.rod(0.035, "fixed", this.fixed, base, foot);
      return top;
    });
    this.elastomers = this.ends.map(() => this.rod(0.045, "elastomer", this.root));
  }

  addStops() {
    this.stops = this.data.stops.map(stop => {
      const width = 0.26;
      const size = [width, width, width];
      size[stop.axis] = wemsPlate;
      const plate = this.mesh(new THREE.BoxBufferGeometry(...size), "stop", this.fixed);
      plate.material = plate.material.clone();
      return plate;
    });
  }

  // A point of a part's frame (m) in drawing units.
  place3(at) {
    return new THREE.Vector3(...at).sub(this.center).divideScalar(this.size);
  }

  addShapes() {
    for (const shape of this.data.shapes) {
      const material = shape.part === "fixed" ? "fixed" : shape.kind === "box" || shape.kind === "stl" ? "shell" : "mobile";
      const mesh = this.mesh(this.shapeGeometry(shape), material, this[shape.part]);
      const theta = new THREE.Vector3(...shape.theta), angle = theta.length();
      if (angle > 0) mesh.quaternion.setFromAxisAngle(theta.divideScalar(angle), angle);
      mesh.position.copy(this.place3(shape.at));
      const edges = new THREE.LineSegments(new THREE.EdgesGeometry(mesh.geometry, 30), this.lines());
      mesh.add(edges);
    }
  }

  lines() {
    this.materials.edge = this.materials.edge || new THREE.LineBasicMaterial();
    return this.materials.edge;
  }

  shapeGeometry(shape) {
    const [x, y, z] = shape.size.map(length => length / this.size);
    if (shape.kind === "cylinder") return new THREE.CylinderBufferGeometry(x / 2, x / 2, z, 48).rotateX(Math.PI / 2);
    if (shape.kind !== "stl") return new THREE.BoxBufferGeometry(x, y, z);
    const geometry = new THREE.BufferGeometry(), { unit, values } = shape.corners;
    const corners = new Float32Array(values.map(value => value * unit / this.size));
    geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    geometry.computeVertexNormals();
    return geometry;
  }

  // On top of the pin where a sensor sits at a connection.
  addSensors() {
    const size = wemsSensorSize;
    for (const sensor of this.data.sensors) {
      const cube = this.mesh(new THREE.BoxBufferGeometry(size, size, size), "sensor", this[sensor.part]);
      cube.position.copy(this.place3(sensor.at));
      const end = this.ends.findIndex(other => other.distanceTo(cube.position) < wemsPinSize);
      if (end < 0) continue;
      if (sensor.part === "fixed") cube.position.copy(this.posts[end]);
      cube.position.z += wemsPinSize + size / 2;
    }
  }

  // A round length that is about half of the drawing's size; not exaggerated.
  addScaleBar() {
    const wanted = 0.6 * this.size, power = 10 ** Math.floor(Math.log10(wanted));
    const length = power * [5, 2, 1].find(factor => factor * power <= wanted), half = length / this.size / 2;
    const bounds = new THREE.Box3().setFromPoints(this.posts).expandByObject(this.fixed).expandByObject(this.mobile);
    const y = bounds.min.y - 0.15, z = bounds.min.z;
    this.rod(0.012, "ink", this.root, new THREE.Vector3(-half, y, z), new THREE.Vector3(half, y, z));
    for (const end of [-half, half])
      this.rod(0.012, "ink", this.root, new THREE.Vector3(end, y, z - 0.05), new THREE.Vector3(end, y, z + 0.05));
    this.scaleText = length >= 1 ? +length.toPrecision(1) + " m" : +(1e3 * length).toPrecision(1) + " mm";
    this.scaleLabel = new THREE.Sprite(new THREE.SpriteMaterial({ transparent: true, depthTest: false }));
    this.scaleLabel.position.set(0, y, z - 0.16);
    this.scaleLabel.scale.set(0.8, 0.2, 1);
    this.root.add(this.scaleLabel);
    this.scaleEnds = [new THREE.Vector3(0, y, z - 0.2)];
  }

  paintScaleLabel() {
    const canvas = document.createElement("canvas"), context = canvas.getContext("2d");
    canvas.width = 512;
    canvas.height = 128;
    context.font = "72px sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = this.colors.ink.getStyle();
    context.fillText(this.scaleText, 256, 64);
    this.scaleLabel.material.map = new THREE.CanvasTexture(canvas);
    this.scaleLabel.material.needsUpdate = true;
  }

  recolor() {
    const colors = wemsColors();
    for (const name in this.materials) this.materials[name].color.copy(colors[name] || colors.mobile);
    if (this.materials.edge) this.materials.edge.color.copy(colors.ink);
    this.colors = colors;
    this.paintScaleLabel();
  }

  // Pose of one part in drawing units, exaggerated.
  pose(part, factor) {
    const theta = new THREE.Vector3(...part.theta).multiplyScalar(factor);
    const angle = theta.length();
    const rotation = new THREE.Quaternion();
    if (angle > 0) rotation.setFromAxisAngle(theta.divideScalar(angle), angle);
    // The frame's origin is not the centre of the drawing.
    const center = this.center.clone().divideScalar(this.size);
    const position = new THREE.Vector3(...part.p).multiplyScalar(factor / this.size)
      .add(center.clone().applyQuaternion(rotation)).sub(center);
    return new THREE.Matrix4().compose(position, rotation, new THREE.Vector3(1, 1, 1));
  }

  place(frame, factor, holdFixed, showForces, largestForce) {
    const fixed = this.pose(frame.fixed, factor), mobile = this.pose(frame.mobile, factor);
    const back = holdFixed ? new THREE.Matrix4().getInverse(fixed) : new THREE.Matrix4();
    const apply = (group, matrix) => {
      back.clone().multiply(matrix).decompose(group.position, group.quaternion, group.scale);
      group.updateMatrix();
    };
    apply(this.fixed, fixed);
    apply(this.mobile, mobile);
    this.data.stops.forEach((stop, i) => {
      const plate = this.stops[i], away = wemsPinSize + factor * stop.gap / this.size + wemsPlate / 2;
      plate.position.copy(this.ends[stop.connection]);
      plate.position.setComponent(stop.axis, plate.position.getComponent(stop.axis) + stop.side * away);
      plate.material.color.copy(frame.closed[i] ? this.colors.closed : this.colors.stop);
    });
    this.ends.forEach((end, i) => {
      const pin = end.clone().applyMatrix4(this.mobile.matrix);
      WemsDevice.stretch(this.elastomers[i], this.posts[i].clone().applyMatrix4(this.fixed.matrix), pin);
      const force = new THREE.Vector3(...frame.force[i]);
      const length = wemsLongestArrow * force.length() / (largestForce || 1);
      const arrow = this.arrows[i];
      arrow.visible = showForces && length > 0.02;
      if (!arrow.visible) return;
      arrow.position.copy(pin);
      arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0),
                                          force.normalize().applyQuaternion(this.fixed.quaternion));
      const head = Math.min(0.13, length / 2);
      arrow.shaft.scale.y = length - head;
      arrow.shaft.position.y = (length - head) / 2;
      arrow.head.scale.setScalar(head / 0.13);
      arrow.head.position.y = length - head / 2;
    });
  }
}

// One run: frames by number.
class WemsRun {
  constructor(run, connections) {
    this.run = run;
    this.connections = connections;
    const peak = rows => rows.unit * rows.values.reduce((most, v) => Math.max(most, Math.abs(v)), 0);
    this.largestForces = run.stations.map(station => {
      let largest = 0;
      for (let frame = station.from; frame < station.from + station.count; ++frame)
        for (const force of this.forces(frame)) largest = Math.max(largest, Math.hypot(...force));
      return largest;
    });
    this.largestMotion = Math.max(peak(run.mobile.p), peak(run.fixed.p));
  }

  column(rows, frame) {
    return rows.values.slice(rows.rows * frame, rows.rows * (frame + 1)).map(v => v * rows.unit);
  }

  forces(frame) {
    const all = this.column(this.run.force, frame);
    return Array.from({ length: this.connections }, (_, i) => all.slice(3 * i, 3 * i + 3));
  }

  frame(number) {
    const part = data => ({ p: this.column(data.p, number), theta: this.column(data.theta, number) });
    return { mobile: part(this.run.mobile), fixed: part(this.run.fixed), force: this.forces(number),
             closed: [...this.run.closed[number]].map(digit => digit === "1") };
  }
}

// Names and directions to look from.
const wemsViews = [["oblique", [1.7, -2.3, 1.2]], ["along y", [0, -1, 0.05]], ["along x", [1, 0, 0.05]],
                   ["from above", [0, -0.001, 1]]];

// Builds the figure `id`: canvas, what it shows in words, controls.
function wemsScene(id, scene) {
  const figure = document.getElementById(id);
  const runs = scene.runs.map(run => new WemsRun(run, scene.connections.length));
  const device = new WemsDevice(scene);
  const stage = new WemsStage(figure, scene.title, device.bounds, wemsViews);
  if (!stage.renderer) return;
  stage.world.add(device.root);
  const { words, controls } = stage;
  const play = wemsElement("button", { type: "button", "aria-pressed": "false" }, controls, "Play");
  const chooseRun = wemsSelect("Run", scene.runs.map(run => run.name), controls);
  if (runs.length < 2) chooseRun.parentElement.remove();
  const station = wemsRange("Place in the run", { min: 0, max: 0, step: 1, value: 0, class: "wide" }, controls);
  const moment = wemsRange("Moment", { min: 0, max: 0, step: 1, value: 0 }, controls);
  const factor = wemsRange("Exaggeration", { min: 0, max: 100, step: 1, value: 50 }, controls);
  stage.addViewControl();
  const along = wemsCheck("go along the run", true, controls);
  const hold = wemsCheck("hold the fixed part still", true, controls);
  const arrows = wemsCheck("forces on the mobile part", true, controls);

  let run = runs[0], playing = false;
  const exaggeration = () => Math.pow(10, factor.input.value / 100 * Math.log10(run.most));
  const current = () => run.run.stations[station.input.value];

  function update() {
    const place = current(), frame = run.frame(place.from + Number(moment.input.value));
    const largest = run.largestForces[station.input.value];
    device.place(frame, exaggeration(), hold.checked, arrows.checked, largest);
    const time = place.time + moment.input.value * place.period;
    const hertz = Number.isFinite(place.hertz) ? place.hertz.toFixed(2) + " Hz, " : "";
    station.value.textContent = hertz + place.time.toFixed(2) + " s";
    moment.value.textContent = (1e3 * moment.input.value * place.period).toFixed(1) + " ms";
    factor.value.textContent = exaggeration().toFixed(exaggeration() < 10 ? 1 : 0) + " x";
    for (const range of [station, moment, factor]) range.input.setAttribute("aria-valuetext", range.value.textContent);
    const closed = scene.stops.filter((_, i) => frame.closed[i]).map(stop => stop.name);
    const sizes = frame.force.map(force => Math.hypot(...force)), most = sizes.indexOf(Math.max(...sizes));
    words.textContent = hertz + time.toFixed(3) + " s: " +
      (closed.length ? "stop closed: " + closed.join(", ") : "no stop closed") +
      "; largest force " + sizes[most].toFixed(0) + " N at connection " + scene.connections[most].name +
      " (longest arrow at this place: " + largest.toFixed(0) + " N)";
    words.classList.toggle("alert", closed.length > 0);
  }
  function chooseStation() {
    moment.input.max = current().count - 1;
    stage.schedule();
  }
  function selectRun() {
    run = runs[chooseRun.value];
    // The whole range shows the largest motion, or the widest gap, at some share of the drawing.
    const gaps = scene.stops.map(stop => Math.abs(stop.gap));
    const shown = Math.max(run.largestMotion, ...gaps, 1e-9);
    run.most = Math.max(2, Math.pow(wemsDisplayed * device.size / shown, 2));
    station.input.max = run.run.stations.length - 1;
    station.input.value = 0;
    chooseStation();
  }
  let last = 0, fraction = 0;
  function step(now) {
    if (!playing) return;
    const frames = current().count;
    fraction += (now - last) / 1000 / 2 * frames;  // two seconds for what a station holds
    last = now;
    const on = Math.floor(fraction);
    fraction -= on;
    let next = Number(moment.input.value) + on;
    if (next >= frames) {
      next %= frames;
      if (along.checked) {
        station.input.value = (Number(station.input.value) + 1) % run.run.stations.length;
        chooseStation();
      }
    }
    if (on > 0) {
      moment.input.value = next;
      stage.draw();
    }
    requestAnimationFrame(step);
  }
  play.addEventListener("click", () => {
    playing = !playing;
    play.textContent = playing ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(playing));
    last = performance.now();
    if (playing) requestAnimationFrame(step);
  });
  chooseRun.addEventListener("input", selectRun);
  station.input.addEventListener("input", chooseStation);
  for (const input of [moment.input, factor.input, hold, arrows]) input.addEventListener("input", () => stage.schedule());
  selectRun();
  stage.start(() => device.recolor(), update);
}
