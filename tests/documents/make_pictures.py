#!/usr/bin/env python3
"""Saves pictures of reports as SVG, as the button below each picture does, in headless Chromium.

    make_pictures.py PAGE.html "beginning of its title" PICTURE.svg [… PAGE TITLE PICTURE …]

A title of `scene` saves the device that moves, as PNG. Needs Debian's chromium-driver and python3-selenium.
"""
import base64
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "report/browser"))
from check_reports import show, start_browser, two_frames  # noqa: E402

# What is drawn in one picture more than some hundred points a series makes large files and no better pictures.
MOST_POINTS = 500
SAVE = """
const [title, most] = arguments;
const round = v => Number.isFinite(v) ? +v.toPrecision(5) : v;
const wanted = wemsPlots.find(({ plot }) => plot.title.startsWith(title));
if (!wanted) return wemsPlots.map(({ plot }) => plot.title);
const { plot, g, format } = wanted;
const series = plot.series.map(s => {
  const stride = Math.ceil(s.x.length / most), keep = (_, i) => stride < 2 || i % stride === 0;
  return { ...s, x: s.x.filter(keep).map(round), y: s.y.filter(keep).map(round) };
});
return wemsSvg({ ...plot, series }, g, format);"""


def main():
    wanted = sys.argv[1:]
    if len(wanted) < 3 or len(wanted) % 3:
        sys.exit(__doc__)
    browser = start_browser()
    if browser is None:
        sys.exit("no browser")
    for page, title, picture in zip(*[iter(wanted)] * 3):
        browser.get(Path(page).resolve().as_uri())
        show(browser, 1000, False)
        two_frames(browser)
        if title == "scene":
            url = browser.execute_script("return document.querySelector('.scene canvas').toDataURL('image/png')")
            Path(picture).write_bytes(base64.b64decode(url.split(",")[1]))
            continue
        svg = browser.execute_script(SAVE, title, MOST_POINTS)
        if not isinstance(svg, str):
            sys.exit(f"{page}: no picture «{title}» among {svg}")
        Path(picture).write_text(svg)
    browser.quit()


if __name__ == "__main__":
    main()
