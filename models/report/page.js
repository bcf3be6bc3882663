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

function wemsPlot(plot) {
  const format = v => Math.abs(v) >= 1e4 || (v !== 0 && Math.abs(v) < 1e-3) ? v.toExponential(1) : String(+v.toPrecision(4));
  const paint = () => {
    const style = getComputedStyle(document.documentElement);
    return { axisLineColor: style.getPropertyValue("--ink").trim(), gridLineColor: style.getPropertyValue("--line").trim() };
  };
  const g = new Dygraph(document.getElementById(plot.id), wemsRows(plot.series), {
    labels: ["x", ...plot.series.map(s => s.name)], xlabel: plot.x, ylabel: plot.y,
    connectSeparatedPoints: true, drawPoints: plot.points, strokeWidth: plot.points ? 0 : 1.2, pointSize: 1.2,
    legend: "follow", labelsSeparateLines: true, ...paint(),
    colors: ["#0969da", "#cf222e", "#1a7f37", "#9a6700", "#8250df", "#bf3989", "#57606a", "#0a7ea4"],
    axes: { x: { axisLabelFormatter: format, valueFormatter: v => plot.x + " = " + format(v) },
            y: { axisLabelFormatter: format, valueFormatter: v => String(+v.toPrecision(5)), axisLabelWidth: 64 } },
  });
  addEventListener("resize", () => g.resize());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => g.updateOptions(paint()));
}
