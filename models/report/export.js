// Saves what a plot shows, as a picture (SVG, PNG) or as numbers (CSV), from the page itself.
function wemsSave(name, extension, content, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  link.download = name.replace(/[^A-Za-z0-9.+-]+/g, "_").replace(/^_|_$/g, "") + "." + extension;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Steps of 1, 2 or 5 times a power of ten; decades on a logarithmic axis that spans two or more.
function wemsTicks([low, high], most, log) {
  const ticks = [];
  if (log && Math.log10(high / low) >= 2) {
    const stride = Math.ceil(Math.log10(high / low) / most);
    for (let k = Math.ceil(Math.log10(low)); 10 ** k <= high; k += stride) ticks.push(10 ** k);
    return ticks;
  }
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find(factor => factor * power >= raw);
  for (let k = Math.ceil(low / step); k * step <= high; ++k) ticks.push(k * step);
  return ticks;
}

function wemsEscape(text) {
  return text.replace(/[&<>"]/g, c => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", "\"": "&quot;" })[c]);
}

// The part that is in view, of the series that are shown, in the colours of paper. A picture that is saved has its title.
function wemsSvg(plot, g, format, { width = 960, height: innerHeight = 400, titled = true } = {}) {
  const shown = plot.series.filter((_, i) => g.visibility()[i]), across = Math.max(1, Math.floor(width / 300));
  const left = titled ? 90 : 75, right = 20, top = titled ? 40 : 10, inner = { width: width - left - right, height: innerHeight };
  const frame = "frame-" + plot.id, grid = 'fill="none" stroke="#d0d7de"';
  const rows = plot.series.length > 1 ? Math.ceil(shown.length / across) : 0;
  const height = top + inner.height + 60 + 20 * rows;
  const xs = g.xAxisRange(), ys = g.yAxisRange(), scale = plot.logY ? Math.log10 : v => v;
  const toX = x => left + inner.width * (x - xs[0]) / (xs[1] - xs[0]);
  const toY = y => top + inner.height * (scale(ys[1]) - scale(y)) / (scale(ys[1]) - scale(ys[0]));
  const text = (x, y, words, more) => `<text x="${x}" y="${y}" ${more || ""}>${wemsEscape(words)}</text>`;
  const bottom = top + inner.height, parts = [];
  for (const x of wemsTicks(xs, Math.max(3, Math.floor(inner.width / 75)), false))
    parts.push(`<path ${grid} d="M${toX(x)} ${top}V${bottom}"/>`, text(toX(x), bottom + 18, format(x), 'text-anchor="middle"'));
  for (const y of wemsTicks(ys, Math.max(3, Math.floor(inner.height / 45)), plot.logY))
    parts.push(`<path ${grid} d="M${left} ${toY(y)}h${inner.width}"/>`, text(left - 6, toY(y) + 4, format(y), 'text-anchor="end"'));
  if (titled) parts.push(text(left, 24, plot.title, 'font-weight="bold"'));
  parts.push(text(left + inner.width / 2, bottom + 42, plot.x, 'text-anchor="middle"'),
             text(0, 0, plot.y, `text-anchor="middle" transform="translate(20 ${top + inner.height / 2}) rotate(-90)"`));
  shown.forEach((series, i) => {
    const color = wemsLight[series.color % wemsLight.length];
    let path = "", drawn = false;
    series.x.forEach((x, k) => {
      const y = series.y[k], there = Number.isFinite(y) && (!plot.logY || y > 0);
      if (there) path += (drawn && !series.points ? "L" : "M") + toX(x).toFixed(2) + " " + toY(y).toFixed(2) + (series.points ? "h0" : "");
      drawn = there;
    });
    const stroke = series.points ? 'stroke-width="2.4" stroke-linecap="round"' :
      'stroke-width="1.4" stroke-linejoin="round"' + (wemsIsDashed(series) ? ' stroke-dasharray="6 3"' : "");
    parts.push(`<path class="series" clip-path="url(#${frame})" fill="none" stroke="${color}" ${stroke} d="${path}"/>`);
    if (rows === 0) return;
    const x = left + (i % across) * inner.width / across, y = bottom + 66 + 20 * Math.floor(i / across);
    parts.push(`<path d="M${x} ${y - 4}h18" fill="none" stroke="${color}" stroke-width="3"/>`, text(x + 24, y, series.name));
  });
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" ` +
    `font-family="sans-serif" font-size="13" fill="#1b1f24"><title>${wemsEscape(plot.title)}</title>` +
    `<rect width="100%" height="100%" fill="#fff"/>` +
    `<clipPath id="${frame}"><rect x="${left}" y="${top}" width="${inner.width}" height="${inner.height}"/></clipPath>` +
    `${parts.join("\n")}<rect x="${left}" y="${top}" width="${inner.width}" height="${inner.height}" fill="none" stroke="#1b1f24"/></svg>\n`;
}

function wemsPng(name, svg) {
  const picture = new Image(), fine = 2;  // pixels for each unit: sharp in print
  picture.onload = () => {
    const canvas = document.createElement("canvas");
    canvas.width = fine * picture.width;
    canvas.height = fine * picture.height;
    canvas.getContext("2d").drawImage(picture, 0, 0, canvas.width, canvas.height);
    canvas.toBlob(blob => wemsSave(name, "png", blob));
  };
  picture.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(svg);
}

// All that the page holds of the plot: x, then a column for each series.
function wemsCsv(plot) {
  const quote = text => /[",\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
  const header = [plot.x, ...plot.series.map(series => plot.series.length > 1 ? series.name + ", " + plot.y : plot.y)];
  const rows = wemsRows(plot.series).map(row => row.map(value => Number.isFinite(value) ? value : "").join());
  return [header.map(quote).join(), ...rows].join("\n") + "\n";
}

function wemsSaveControls(label, choices, after) {
  const box = document.createElement("div");
  box.className = "save";
  box.setAttribute("role", "group");
  box.setAttribute("aria-label", "Save: " + label);
  box.append("Save as ");
  for (const [name, act] of choices) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.addEventListener("click", act);
    box.append(button);
  }
  after.after(box);
}
