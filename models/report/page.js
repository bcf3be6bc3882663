// Draws one plot: series {name, x, y} ascend in x. dygraphs wants common rows, with null where a series has no value.
function wemsRows(series) {
  const rows = new Map();
  series.forEach((s, column) => s.x.forEach((x, i) => {
    // A second value at the same x gets a row of its own.
    let list = rows.get(x);
    if (!list) rows.set(x, list = []);
    let row = list.find(r => r[column + 1] === null);
    if (!row) list.push(row = [x, ...series.map(() => null)]);
    row[column + 1] = s.y[i];
  }));
  return [...rows.keys()].sort((a, b) => a - b).flatMap(x => rows.get(x));
}

const wemsLight = ["#0969da", "#cf222e", "#1a7f37", "#9a6700", "#8250df", "#bf3989", "#57606a", "#0a7ea4", "#5c3d00", "#e16f24",
                   "#2f6f4f", "#000080"];
const wemsDark = ["#58a6ff", "#ff7b72", "#3fb950", "#d29922", "#bc8cff", "#f778ba", "#8b949e", "#39c5cf", "#e3b98a", "#ffa657",
                  "#9be9a8", "#a5b4fc"];

// Paper is white and as wide as it is, whatever the window.
addEventListener("beforeprint", () => document.documentElement.classList.add("printing"));
addEventListener("afterprint", () => document.documentElement.classList.remove("printing"));

function wemsStyle() {
  const style = getComputedStyle(document.documentElement);
  const printing = document.documentElement.classList.contains("printing");
  const dark = matchMedia("(prefers-color-scheme: dark)").matches && !printing;
  return { axisLineColor: style.getPropertyValue("--ink").trim(), gridLineColor: style.getPropertyValue("--line").trim(),
           colors: dark ? wemsDark : wemsLight };
}

function wemsPalette(plot) {
  const { colors } = wemsStyle();
  return plot.series.map(series => colors[series.color % colors.length]);
}

// More series than colours: the second round is dashed.
function wemsIsDashed(series) {
  return series.color >= wemsLight.length && !series.points;
}

// Names of the series below the plot; each is a button that hides and shows its series.
function wemsLegend(plot, g) {
  const legend = document.createElement("div");
  legend.className = "legend";
  legend.setAttribute("role", "group");
  legend.setAttribute("aria-label", "Series of: " + plot.title);
  const swatches = plot.series.map((series, i) => {
    const button = document.createElement("button"), swatch = document.createElement("i");
    button.type = "button";
    button.append(swatch, series.name);
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(shown));
      g.setVisibility(i, shown);
    });
    legend.append(button);
    return swatch;
  });
  document.getElementById(plot.id).after(legend);
  return () => swatches.forEach((swatch, i) => {
    const color = wemsPalette(plot)[i];
    swatch.style.background = wemsIsDashed(plot.series[i]) ?
      `linear-gradient(90deg, ${color} 40%, transparent 40% 60%, ${color} 60%)` : color;
  });
}

// What a browser records of a canvas for the printer, not all readers of PDF show: on paper a picture of lines stands in
// its place.
function wemsPrintAsSvg(plot, draw) {
  const paper = document.createElement("div"), underneath = 60;  // pixels of numbers and name below the frame
  paper.className = "paper";
  addEventListener("beforeprint", () => {
    paper.innerHTML = draw({ width: plot.clientWidth, height: plot.clientHeight - underneath });
    plot.after(paper);
  });
  addEventListener("afterprint", () => paper.remove());
}

const wemsPlots = [];  // all of the page, for whoever saves them by a script

function wemsPlot(plot) {
  const format = v => Math.abs(v) >= 1e4 || (v !== 0 && Math.abs(v) < 1e-4) ? v.toExponential(1) : String(+v.toPrecision(4));
  const own = {};  // options of each series
  for (const series of plot.series)
    own[series.name] = { drawPoints: series.points, strokePattern: wemsIsDashed(series) ? [6, 3] : null,
                         strokeWidth: series.points ? 0 : plot.series.some(s => s.points) ? 2 : 1.2 };
  const g = new Dygraph(document.getElementById(plot.id), wemsRows(plot.series), {
    labels: ["x", ...plot.series.map(s => s.name)], xlabel: plot.x, ylabel: plot.y,
    connectSeparatedPoints: true, series: own, pointSize: 1.2, logscale: plot.logY, yRangePad: 6,
    legend: "follow", labelsSeparateLines: true, ...wemsStyle(), colors: wemsPalette(plot),
    axes: { x: { pixelsPerLabel: 45, axisLabelFormatter: format, valueFormatter: v => plot.x + " = " + format(v) },
            y: { axisLabelFormatter: format, valueFormatter: v => String(+v.toPrecision(5)), axisLabelWidth: 70 } },
  });
  wemsPlots.push({ plot, g, format });
  const paintLegend = plot.series.length > 1 ? wemsLegend(plot, g) : () => {};
  paintLegend();
  wemsSaveControls(plot.title, [["SVG", () => wemsSave(plot.title, "svg", wemsSvg(plot, g, format), "image/svg+xml")],
                                ["PNG", () => wemsPng(plot.title, wemsSvg(plot, g, format))],
                                ["CSV", () => wemsSave(plot.title, "csv", wemsCsv(plot), "text/csv")]],
                   document.getElementById(plot.id).parentElement.lastElementChild);
  const repaint = () => {
    g.resize();
    g.updateOptions({ ...wemsStyle(), colors: wemsPalette(plot) });
    paintLegend();
  };
  addEventListener("resize", () => g.resize());
  wemsPrintAsSvg(document.getElementById(plot.id), size => wemsSvg(plot, g, format, { ...size, titled: false }));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
}
