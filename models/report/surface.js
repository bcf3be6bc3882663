// A force over displacement and velocity: sheets over a grid of cells, and points, in a box of unit half width.
const wemsBoxHeight = 0.75;
const wemsSurfaceViews = [["oblique", [-1.5, -2.2, 1.1]], ["force over displacement", [0, -1, 0.02]],
                          ["force over velocity", [1, 0, 0.02]], ["from above", [0, -0.001, 1]]];

// A text of `pixels` on the screen, however near, that always faces the camera; see resizeTexts().
function wemsSprite(text, pixels, color) {
  const canvas = document.createElement("canvas"), context = canvas.getContext("2d"), size = 48;
  const font = size + "px system-ui, sans-serif";
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 8;
  canvas.height = 1.4 * size;
  context.font = font;
  context.fillStyle = color;
  context.textBaseline = "middle";
  context.fillText(text, 4, canvas.height / 2);
  const texture = new THREE.CanvasTexture(canvas);
  texture.minFilter = THREE.LinearFilter;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: texture, depthTest: false, sizeAttenuation: false }));
  sprite.userData.size = [pixels * canvas.width / size, pixels * canvas.height / size];
  return sprite;
}

// One axis: values to -1 … 1 (times `half`), with round numbers to write at it.
class WemsAxis {
  constructor(values, label, half) {
    const finite = values.filter(Number.isFinite);
    this.low = Math.min(...finite);
    this.high = Math.max(...finite);
    if (!(this.high > this.low)) this.high = this.low + 1;
    this.label = label;
    this.half = half;
  }

  place(value) {
    return this.half * (2 * (value - this.low) / (this.high - this.low) - 1);
  }

  ticks() {
    const rough = (this.high - this.low) / 4, power = Math.pow(10, Math.floor(Math.log10(rough)));
    const step = power * [1, 2, 5, 10].find(factor => factor * power >= rough);
    const ticks = [];
    for (let k = Math.ceil(this.low / step); k * step <= this.high; ++k) ticks.push(+(k * step).toPrecision(6));
    return ticks;
  }
}

class WemsSurfacePicture {
  constructor(data) {
    this.data = data;
    this.root = new THREE.Group();
    this.frame = new THREE.Group();
    this.root.add(this.frame);
    const z = data.sheets.flatMap(sheet => sheet.values);
    this.axes = [new WemsAxis(data.x.values, data.x.label, 1), new WemsAxis(data.y.values, data.y.label, 1),
                 new WemsAxis(z, data.z.label, wemsBoxHeight)];
    this.sheets = data.sheets.map(sheet => this.makeSheet(sheet));
    this.recolor();
  }

  // The middle of cell (i, j); null where it is empty.
  middle(sheet, i, j) {
    const value = sheet.values[i * this.data.y.values.length + j];
    if (!Number.isFinite(value)) return null;
    return new THREE.Vector3(this.axes[0].place(this.data.x.values[i]), this.axes[1].place(this.data.y.values[j]),
                             this.axes[2].place(value));
  }

  makeSheet(sheet) {
    const group = new THREE.Group(), nx = this.data.x.values.length, ny = this.data.y.values.length;
    const at = [], lines = [], faces = [];
    for (let i = 0; i < nx; ++i) for (let j = 0; j < ny; ++j) at.push(this.middle(sheet, i, j));
    const line = (a, b) => { if (a && b) lines.push(a, b); };
    const face = (...corners) => { if (corners.every(corner => corner)) faces.push(...corners); };
    for (let i = 0; i < nx; ++i) {
      for (let j = 0; j < ny; ++j) {
        const p = at[i * ny + j], right = at[(i + 1) * ny + j], up = at[i * ny + j + 1];
        if (i + 1 < nx) line(p, right);
        if (j + 1 < ny) line(p, up);
        if (i + 1 < nx && j + 1 < ny) {
          const far = at[(i + 1) * ny + j + 1];
          face(p, right, far);
          face(p, far, up);
        }
      }
    }
    const geometry = points => new THREE.BufferGeometry().setFromPoints(points);
    if (sheet.points) {
      group.add(new THREE.Points(geometry(at.filter(point => point)), new THREE.PointsMaterial({ size: 0.055 })));
    } else {
      group.add(new THREE.LineSegments(geometry(lines), new THREE.LineBasicMaterial()));
      group.add(new THREE.Mesh(geometry(faces), new THREE.MeshBasicMaterial(
        { side: THREE.DoubleSide, transparent: true, opacity: 0.22, depthWrite: false })));
    }
    this.root.add(group);
    return group;
  }

  // The box's edges, numbers and labels, in the page's ink.
  drawFrame() {
    for (const child of [...this.frame.children]) this.frame.remove(child);
    const ink = getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
    const height = wemsBoxHeight, corner = (x, y, z) => new THREE.Vector3(x, y, z * height), edges = [];
    for (const a of [-1, 1]) for (const b of [-1, 1])
      edges.push(corner(-1, a, b), corner(1, a, b), corner(a, -1, b), corner(a, 1, b), corner(a, b, -1), corner(a, b, 1));
    const material = new THREE.LineBasicMaterial({ color: wemsColors().fixed, transparent: true, opacity: 0.6 });
    this.frame.add(new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(edges), material));
    const write = (text, size, x, y, z) => {
      const sprite = wemsSprite(text, size, ink);
      sprite.position.set(x, y, z);
      this.frame.add(sprite);
    };
    const [x, y, z] = this.axes, small = 12, large = 14;
    for (const tick of x.ticks()) write(String(tick), small, x.place(tick), -1.14, -height - 0.06);
    for (const tick of y.ticks()) write(String(tick), small, -1.16, y.place(tick), -height - 0.06);
    for (const tick of z.ticks()) write(String(tick), small, 1.16, -1.1, z.place(tick));
    write(x.label, large, 0.1, -1.42, -height - 0.16);
    write(y.label, large, -1.46, 0.1, -height - 0.16);
    write(z.label, large, 0.85, -1, height + 0.16);
  }

  // To the stage's present size.
  resizeTexts(stage) {
    const pixel = 2 * Math.tan(THREE.Math.degToRad(stage.camera.fov / 2)) / stage.box.clientHeight;
    for (const { scale, userData } of this.frame.children)
      if (userData.size) scale.set(userData.size[0] * pixel, userData.size[1] * pixel, 1);
  }

  recolor() {
    this.drawFrame();
    const { colors } = wemsStyle();
    this.sheets.forEach((group, i) => {
      const color = new THREE.Color(colors[this.data.sheets[i].color % colors.length]);
      for (const part of group.children) part.material.color.copy(color);
    });
  }
}

// Builds the figure `id`: canvas, what it shows in words, a box to tick for each sheet.
function wemsSurface(id, data) {
  const picture = new WemsSurfacePicture(data);
  const stage = new WemsStage(document.getElementById(id), data.title, new THREE.Sphere(new THREE.Vector3(0, 0, -0.1), 2.2),
                              wemsSurfaceViews);
  const range = axis => axis.label + " from " + +axis.low.toPrecision(3) + " to " + +axis.high.toPrecision(3);
  stage.words.textContent = picture.axes.map(range).join(", ") + ".";
  if (!stage.renderer) return;
  stage.world.add(picture.root);
  stage.addViewControl();
  const boxes = data.sheets.map(sheet => {
    const box = wemsCheck(sheet.name, true, stage.controls), swatch = document.createElement("i");
    box.parentElement.append(" ", swatch);
    box.addEventListener("input", () => stage.schedule());
    return { box, swatch };
  });
  const recolor = () => {
    picture.recolor();
    boxes.forEach(({ swatch }, i) => {
      const { colors } = wemsStyle();
      swatch.style.background = colors[data.sheets[i].color % colors.length];
    });
  };
  stage.start(recolor, () => {
    picture.resizeTexts(stage);
    boxes.forEach(({ box }, i) => { picture.sheets[i].visible = box.checked; });
  });
}
