// Draws one plot: rows ascend in x, a series without a value at some x has null there.
function wemsPlot(plot) {
  const style = getComputedStyle(document.documentElement);
  const ink = style.getPropertyValue("--ink").trim();
  const grid = style.getPropertyValue("--line").trim();
  const format = v => Math.abs(v) >= 1e4 || (v !== 0 && Math.abs(v) < 1e-3) ? v.toExponential(1) : String(+v.toPrecision(4));
  const g = new Dygraph(document.getElementById(plot.id), plot.rows, {
    labels: ["x", ...plot.names], xlabel: plot.x, ylabel: plot.y,
    connectSeparatedPoints: true, drawPoints: plot.points, strokeWidth: plot.points ? 0 : 1.2, pointSize: 1.2,
    legend: "follow", labelsSeparateLines: true, axisLineColor: ink, gridLineColor: grid,
    colors: ["#0969da", "#cf222e", "#1a7f37", "#9a6700", "#8250df", "#bf3989", "#57606a", "#0a7ea4"],
    axes: { x: { axisLabelFormatter: format, valueFormatter: v => plot.x + " = " + format(v) },
            y: { axisLabelFormatter: format, valueFormatter: v => String(+v.toPrecision(5)), axisLabelWidth: 64 } },
  });
  addEventListener("resize", () => g.resize());
}
