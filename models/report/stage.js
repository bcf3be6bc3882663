// What the three-dimensional pictures share: controls, and a stage with camera and light.
let wemsControls = 0;
function wemsUniqueId() {
  return "control" + ++wemsControls;
}

function wemsElement(name, attributes, parent, text) {
  const element = document.createElement(name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (text) element.textContent = text;
  parent.append(element);
  return element;
}

function wemsRange(label, attributes, parent) {
  const box = wemsElement("div", {}, parent), id = wemsUniqueId();
  wemsElement("label", { for: id }, box, label);
  const value = wemsElement("output", { for: id }, box);
  return { input: wemsElement("input", { type: "range", id, ...attributes }, box), value };
}

function wemsCheck(label, checked, parent) {
  const box = wemsElement("label", { class: "check" }, parent);
  const input = wemsElement("input", { type: "checkbox" }, box);
  box.append(" " + label);
  input.checked = checked;
  return input;
}

function wemsSelect(label, choices, parent) {
  const box = wemsElement("label", {}, parent, label + " ");
  const select = wemsElement("select", {}, box);
  choices.forEach((choice, i) => wemsElement("option", { value: i }, select, choice));
  return select;
}

function wemsColors() {
  const style = getComputedStyle(document.documentElement);
  const read = name => new THREE.Color(style.getPropertyValue(name).trim());
  return { ink: read("--ink"), paper: read("--paper"), mobile: read("--mobile"), fixed: read("--fixed"),
           elastomer: read("--elastomer"), stop: read("--stop"), closed: read("--closed"), force: read("--force"), sensor: read("--sensor") };
}

// A canvas in a figure, what it shows in words, and a camera that turns when it is dragged. It is drawn again whenever
// something changes; `renderer` is missing where the browser has no WebGL.
class WemsStage {
  constructor(figure, label, bounds, views) {
    this.figure = figure;
    this.label = label;
    this.bounds = bounds;  // a sphere around all that is drawn
    this.views = views;    // names and directions to look from
    this.box = wemsElement("div", { class: "stage", role: "img", "aria-label": label }, figure);
    this.words = wemsElement("p", { class: "words" }, figure);
    try {
      this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });  // kept for printing
    } catch (error) {
      this.box.remove();
      this.words.textContent = "This browser has no WebGL, which this picture needs.";
      return;
    }
    this.box.append(this.renderer.domElement);
    this.controls = wemsElement("div", { class: "controls", role: "group", "aria-label": "Controls: " + label }, figure);
    this.world = new THREE.Scene();
    const lamp = new THREE.DirectionalLight(0xffffff, 0.65);
    lamp.position.set(1, -2, 3);
    this.world.add(new THREE.AmbientLight(0xffffff, 0.55), lamp);
    this.camera = new THREE.PerspectiveCamera(38, 1, 0.1, 50);
    this.camera.up.set(0, 0, 1);
    this.orbit = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.orbit.enableZoom = this.orbit.enablePan = this.orbit.enableKeys = false;  // wheel and keys belong to the page
    this.orbit.target.copy(bounds.center);
    this.due = false;
  }

  addViewControl() {
    this.view = wemsSelect("View", this.views.map(v => v[0]), this.controls);
    this.view.addEventListener("input", () => this.look());
  }

  // From now on: `recolor` when light turns to dark, `update` before each drawing.
  start(recolor, update) {
    this.update = update;
    const paint = () => {
      recolor();
      this.renderer.setClearColor(wemsColors().paper);
      this.schedule();
    };
    this.orbit.addEventListener("change", () => this.schedule());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
    addEventListener("resize", () => this.resize());
    for (const event of ["beforeprint", "afterprint"]) addEventListener(event, () => {
      this.resize();
      paint();
      this.draw();  // no frame comes before the printer looks
    });
    this.resize();
    paint();
    this.draw();
    const save = () => this.renderer.domElement.toBlob(blob => wemsSave(this.label, "png", blob));
    wemsSaveControls(this.label, [["PNG", save]], this.figure.lastElementChild);
  }

  draw() {
    this.due = false;
    this.update();
    this.renderer.render(this.world, this.camera);
  }

  schedule() {
    if (!this.due) requestAnimationFrame(() => this.draw());
    this.due = true;
  }

  resize() {
    const width = this.box.clientWidth, height = this.box.clientHeight;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.look();
  }

  look() {
    const half = THREE.Math.degToRad(this.camera.fov / 2);  // of the shorter side
    const distance = this.bounds.radius / Math.sin(Math.atan(Math.tan(half) * Math.min(1, this.camera.aspect)));
    const direction = new THREE.Vector3(...this.views[this.view.value][1]).normalize();
    this.camera.position.copy(direction).multiplyScalar(0.78 * distance).add(this.orbit.target);
    this.orbit.update();
    this.schedule();
  }
}
