#!/usr/bin/env python3
"""Opens the reports of all commands in headless Chromium: every picture drawn, controls that work, no console error, no
network, units at every axis, accessible names, contrast, light and dark, 1400 and 390 pixels, curves on paper. Screenshots
and the pages as PDF stay in the output folder.

    check_reports.py --simulate PROGRAM --identify PROGRAM --device MODEL.toml --out FOLDER

Exit status 77: there is no browser or no Selenium (Debian: chromium-driver, python3-selenium), nothing was checked.
"""
import argparse
import base64
import bisect
import csv
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
import zlib
from pathlib import Path

from check_saving import check_saving
from make_reports import make_reports

SKIPPED = 77
LARGEST_PAGE = 10e6  # bytes
FEWEST_COLOURED = 130  # pixels of a plot on paper at 36 dpi; names of series without curves have 12 to 115, curves 160 and more
FEWEST_PIECES = 100  # of the paths of a plot on paper: grid and frame without a curve have some twenty
WIDTHS = (1400, 390)
TABLES = {"set"}  # pages of a table alone
TRIED = "fit"  # the page whose controls are used; on the others they come from the same code
EXPECTED = {  # beginnings of titles
    "simulate": ["Envelope: relative displacement z", "Envelope: connection force z", "Mobile part, acceleration z"],
    "fit": ["Singular values", "Restoring force at 1.x", "Restoring force at 4.z", "Restoring force surface at",
            "Unexplained force", "Unexplained moment", "Spectrum of the force", "Autocorrelation"],
    "diagnose": ["Restoring force at 4.z", "Restoring force surface at", "Envelope of the motion", "Amplitude of order 3"],
    "merge": ["Common channel load.fz", "mobile, displacement"],
    "convert": ["mobile, displacement", "fixed, acceleration"],
    "element": ["Force over displacement"],
    "surface": ["Force over displacement", "Restoring force surface"],
    "modes": ["Mode shapes", "Amplitude for each m/s^2, relative displacement z", "Density, connection force z"],
    "response": ["Relative displacement 4.z"],
    "spectra": ["H1 of mobile part, acceleration z", "Coherence of", "First order of", "Density of", "Shock response of"],
    "compare": ["Error by band", "Envelope of the relative displacement", "Around the largest motion", "Around the largest error",
                "Order 1 at", "Order 3 at", "Spectrum of the relative displacement"],
    "inspect": ["Order 1 along the sweep", "Phase of order 1"],
}
CLEARANCE = 1.57e-3  # m, of the axial stops of the shipped device

# Shares of pixels that differ from the corner's, of each canvas, and the number of colours there.
CANVASES = """
return [...document.querySelectorAll(arguments[0])].map(canvas => {
  const copy = document.createElement("canvas");
  copy.width = canvas.width; copy.height = canvas.height;
  const context = copy.getContext("2d");
  context.drawImage(canvas, 0, 0);
  const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
  let drawn = 0;
  const colors = new Set();
  for (const pixel of pixels) { if (pixel !== pixels[0]) ++drawn; colors.add(pixel); }
  return [drawn / pixels.length, colors.size];
});"""

# Texts whose contrast with the page is below 4.5 (WCAG 2.1, 1.4.3).
FAINT = """
const parse = text => text.match(/[\\d.]+/g).map(Number);
const luminance = color => color.slice(0, 3).map(c => c / 255)
  .map(c => c <= 0.03928 ? c / 12.92 : Math.pow((c + 0.055) / 1.055, 2.4))
  .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
const faint = [];
for (const element of document.querySelectorAll("h1,h2,p,td,th,pre,figcaption,label,output,.dygraph-axis-label,.dygraph-label")) {
  if (!element.textContent.trim()) continue;
  let behind = element;
  while (behind && parse(getComputedStyle(behind).backgroundColor)[3] === 0) behind = behind.parentElement;
  const back = parse(getComputedStyle(behind || document.body).backgroundColor);
  const style = getComputedStyle(element), opacity = Number(style.opacity);
  const front = parse(style.color).slice(0, 3).map((c, i) => opacity * c + (1 - opacity) * back[i]);
  const [high, low] = [luminance(front), luminance(back)].sort((a, b) => b - a);
  const contrast = (high + 0.05) / (low + 0.05);
  if (contrast < 4.5) faint.push(element.tagName + " '" + element.textContent.trim().slice(0, 40) + "' " + contrast.toFixed(2));
}
return faint;"""

# Roles of what a screen reader names; Chromium calls a list of choices by either name.
CONTROLS = {"button", "checkbox", "combobox", "listbox", "PopUpButton", "ComboBoxSelect", "radio", "slider", "spinbutton", "textbox"}
PICTURES = {"img", "image"}
SHOWN = """return [...document.querySelectorAll("[role=img], [role=group], button, input, select")]
  .filter(element => element.checkVisibility()).map(element => element.tagName);"""

# Characters of the lines of each plot on paper.
PAPER = """
return [...document.querySelectorAll(".paper svg")].map(svg =>
  [...svg.querySelectorAll(".series")].reduce((sum, path) => sum + path.getAttribute("d").length, 0));"""

SET = """arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event("input"));"""


class Checks:
    def __init__(self):
        self.failures, self.count = [], 0

    def check(self, passed, what):
        self.count += 1
        if not passed:
            self.failures.append(what)
            print("FAILED:", what)


def start_browser():
    """A headless Chromium, or None where there is none."""
    try:
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
    except ImportError:
        print("skipped: no Selenium for this Python (Debian: python3-selenium)")
        return None
    driver, browser = shutil.which("chromedriver"), shutil.which("chromium")
    if not driver or not browser:
        print("skipped: no chromium and chromedriver (Debian: chromium-driver)")
        return None
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    arguments = ["--headless=new", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader", "--hide-scrollbars"]
    if os.geteuid() == 0:
        arguments.append("--no-sandbox")  # which Chromium insists on
    for argument in arguments:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(driver), options=options)


def show(browser, width, dark):
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False})


def save_screenshot(browser, file):
    picture = browser.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True})
    file.write_bytes(base64.b64decode(picture["data"]))


def find(browser, selector):
    return browser.find_elements("css selector", selector)


def two_frames(browser):
    browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done));")


def wait_for(condition, seconds=20):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def check_pictures(browser, name, checks):
    plots, scenes = find(browser, ".plot"), find(browser, ".scene")
    checks.check(plots or name.split()[0] in TABLES, f"{name}: there are plots")
    # dygraphs draws on the second of two canvases; the first holds grid and highlights.
    drawn = browser.execute_script(CANVASES, ".plot canvas")
    checks.check(len(drawn) == 2 * len(plots), f"{name}: two canvases for each plot")
    for i in range(len(plots)):
        best = max(drawn[2 * i:2 * i + 2])
        checks.check(best[0] > 0.0005, f"{name}: plot {i + 1} is drawn")
    for share, colors in browser.execute_script(CANVASES, ".scene canvas"):
        checks.check(share > 0.03 and colors > 100, f"{name}: the device is drawn")
    checks.check(len(find(browser, ".scene canvas")) == len(scenes), f"{name}: a canvas for each moving picture")
    surfaces = browser.execute_script(CANVASES, ".surface canvas")
    checks.check(len(surfaces) == len(find(browser, ".surface")), f"{name}: a canvas for each surface")
    for share, colors in surfaces:
        checks.check(share > 0.03 and colors > 20, f"{name}: the surface is drawn")
    for label in browser.execute_script(
            "return [...document.querySelectorAll('.plot')].map(p => p.querySelectorAll('.dygraph-axis-label').length)"):
        checks.check(label >= 4, f"{name}: a plot has numbers at its axes")


def check_units(browser, name, checks):
    """Every axis says its unit, `[mm]`, or that it has none, `[-]`."""
    labels = browser.execute_script(
        "return [...document.querySelectorAll('.dygraph-xlabel, .dygraph-ylabel')].map(label => label.textContent)")
    bare = [label for label in labels if "[" not in label]
    checks.check(not bare, f"{name}: axes without unit: {bare[:3]}")


def check_paper(browser, name, checks, out):
    """Printed, no plot is empty: each is lines on the paper, and what moves is an image."""
    show(browser, WIDTHS[0], True)  # a dark screen prints on white paper all the same
    browser.execute_script("dispatchEvent(new Event('beforeprint'))")
    two_frames(browser)
    plots = len(find(browser, ".plot"))
    lengths = browser.execute_script(PAPER)
    checks.check(len(lengths) == plots and all(lengths), f"{name}: each plot has lines on the paper: {lengths}")
    browser.execute_script("dispatchEvent(new Event('afterprint'))")
    checks.check(not find(browser, ".paper"), f"{name}: the paper's pictures leave the screen again")
    paper = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})["data"])
    (out / f"{name}.pdf").write_bytes(paper)
    moving = len(find(browser, ".scene canvas, .surface canvas"))
    images = paper.count(b"/Subtype /Image")
    checks.check(images >= moving, f"{name}: {images} images on paper of {moving} pictures in space")
    pieces = count_pieces(paper)
    checks.check(pieces >= FEWEST_PIECES * plots, f"{name}: {pieces} lines on paper in {plots} plots")
    coloured = count_coloured(out / f"{name}.pdf")
    checks.check(coloured >= FEWEST_COLOURED * plots, f"{name}: {coloured} coloured pixels on paper in {plots} plots")


def count_pieces(paper):
    """Pieces of all paths of a PDF, straight and bent; a plot is drawn by paths, not as an image."""
    pieces = 0
    for start in re.finditer(rb"stream\r?\n", paper):
        try:
            content = zlib.decompress(paper[start.end():paper.find(b"endstream", start.end())])
        except zlib.error:
            continue
        pieces += len(re.findall(rb" [lc]\s", content))
    return pieces


def count_coloured(file):
    """Pixels of the pages that are neither black nor white nor grey, as another program than the browser draws them."""
    pages = subprocess.run(["pdftoppm", "-r", "36", str(file)], check=True, capture_output=True).stdout
    coloured, at = 0, 0
    while at < len(pages):
        header = re.compile(rb"P6\s+(\d+)\s+(\d+)\s+255\s").match(pages, at)
        at = header.end() + 3 * int(header[1]) * int(header[2])
        pixels = memoryview(pages)[header.end():at]
        coloured += sum(max(pixel) - min(pixel) > 60 for pixel in zip(pixels[::3], pixels[1::3], pixels[2::3]))
    return coloured


def check_page(browser, name, checks, out):
    for dark in (False, True):
        for width in WIDTHS:
            view = f"{name} {'dark' if dark else 'light'} {width}"
            show(browser, width, dark)
            two_frames(browser)
            checks.check(browser.execute_script("return document.documentElement.scrollWidth") <= width,
                         f"{view}: the page is not wider than the window")
            faint = browser.execute_script(FAINT)
            checks.check(not faint, f"{view}: contrast of {faint[:3]}")
            if dark == (width == WIDTHS[1]):  # light and wide, dark and narrow
                check_pictures(browser, view, checks)
                save_screenshot(browser, out / f"{view.replace(' ', '_')}.png")
    background = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    checks.check(background != "rgb(255, 255, 255)", f"{name}: dark is dark")


def check_names(browser, name, checks):
    checks.check(len(find(browser, "h1")) == 1 and browser.title, f"{name}: one title")
    checks.check(browser.execute_script("return document.documentElement.lang") == "en", f"{name}: language")
    nodes = {node["nodeId"]: node for node in browser.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]}

    def role_and_name(node):
        return (node.get("role", {}).get("value"), node.get("name", {}).get("value", "").strip()) if not node["ignored"] else (None, "")

    def controls_below(node):
        for child in (nodes[key] for key in node.get("childIds", []) if key in nodes):
            role, own = role_and_name(child)
            yield from [own] if role in CONTROLS else controls_below(child)

    known = [node for node in nodes.values() if role_and_name(node)[0] in CONTROLS | PICTURES | {"group"}]
    shown = browser.execute_script(SHOWN)
    checks.check(len(known) >= len(shown), f"{name}: {len(known)} parts in the tree of names, {len(shown)} on the page")
    for node in known:
        role, own = role_and_name(node)
        checks.check(own, f"{name}: accessible name of a {role}")
        if role == "group":
            names = list(controls_below(node))
            checks.check(len(names) == len(set(names)), f"{name}: names of the controls of a group differ: {names}")


def picture_of(browser, figure=".scene"):
    return browser.execute_script("return document.querySelector(arguments[0] + ' canvas').toDataURL()", figure)


def check_contact(words, name, out, checks):
    """The axial stop that the picture says is closed is closed in the recording at that time."""
    said = re.search(r"([\d.]+) s: stop closed:.*?(\d)\.z\.([+-])", words)
    checks.check(said, f"{name}: an axial stop closes, in: {words}")
    if not said:
        return
    with open(out / "axial.csv", newline="") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        header = [column.split(" ")[0] for column in next(rows)]
        columns = [header.index(column) for column in ("time", f"mobile.{said[2]}.z", f"fixed.{said[2]}.z")]
        time_z = [[float(row[column]) for column in columns] for row in rows]
    _, mobile, fixed = min(time_z, key=lambda row: abs(row[0] - float(said[1])))
    travel = (mobile - fixed) * (1 if said[3] == "+" else -1)
    checks.check(travel > CLEARANCE - 2e-5, f"{name}: {said[0]}, but the travel is {1e3 * travel:.3f} mm")


def check_scene(browser, name, out, checks):
    """Each control of the moving picture changes it."""
    from selenium.webdriver.common.keys import Keys
    shown = [e for e in find(browser, ".scene .controls button, .scene .controls input, .scene .controls select") if e.is_displayed()]
    control = {element.accessible_name.split(" ")[0]: element for element in shown}
    words = lambda: find(browser, ".scene .words")[0].text

    def changes(what, act):
        before = picture_of(browser)
        act()
        two_frames(browser)
        checks.check(picture_of(browser) != before, f"{name}: {what} changes the picture")

    stations = int(control["Place"].get_attribute("max")) + 1
    checks.check(stations >= 30, f"{name}: {stations} places along the run")
    changes("the place in the run", lambda: browser.execute_script(SET, control["Place"], stations * 7 // 10))
    changes("the moment", lambda: browser.execute_script(SET, control["Moment"], 9))
    changes("exaggeration", lambda: browser.execute_script(SET, control["Exaggeration"], 80))
    changes("holding the fixed part", control["hold"].click)
    changes("hiding the forces", control["forces"].click)
    changes("the view", lambda: browser.execute_script(SET, control["View"], 1))
    before = words()
    control["Moment"].send_keys(Keys.ARROW_RIGHT)
    two_frames(browser)
    checks.check(words() != before, f"{name}: the keyboard moves the moment")
    # The run reaches stops from the resonance on; the picture says so in words.
    closed = any(seek(browser, control, station, moment) for station in range(stations // 2, stations, 3)
                 for moment in range(0, int(control["Moment"].get_attribute("max")), 6))
    checks.check(closed, f"{name}: a stop closes")
    check_contact(words(), name, out, checks)
    control["Play"].click()
    checks.check(control["Play"].text == "Pause", f"{name}: Play turns into Pause")
    start = control["Moment"].get_attribute("value")
    checks.check(wait_for(lambda: control["Moment"].get_attribute("value") != start), f"{name}: playing moves on")
    control["Play"].click()
    two_frames(browser)
    still = picture_of(browser)
    two_frames(browser)
    checks.check(picture_of(browser) == still, f"{name}: Pause stops")


def seek(browser, control, station, moment):
    browser.execute_script(SET, control["Place"], station)
    browser.execute_script(SET, control["Moment"], moment)
    two_frames(browser)
    return "stop closed:" in find(browser, ".scene .words")[0].text


def check_zoom(browser, name, checks):
    """Dragging over a plot zooms, a double click goes back."""
    from selenium.webdriver import ActionChains
    plot = find(browser, ".plot")[0]
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", plot)
    labels = lambda: browser.execute_script(
        "return [...arguments[0].querySelectorAll('.dygraph-axis-label-x')].map(e => e.textContent).join()", plot)
    whole = labels()
    ActionChains(browser).move_to_element(plot).click_and_hold().move_by_offset(120, 0).release().perform()
    checks.check(wait_for(lambda: labels() != whole, 5), f"{name}: dragging zooms")
    ActionChains(browser).move_to_element(plot).double_click().perform()
    checks.check(wait_for(lambda: labels() == whole, 5), f"{name}: a double click shows all again")


def check_legend(browser, name, checks):
    """A name below a plot hides its series."""
    buttons = find(browser, ".legend button")
    if not buttons:
        return
    drawn = lambda: browser.execute_script(
        "return [...document.querySelector('.legend').previousElementSibling.querySelectorAll('canvas')].map(c => c.toDataURL()).join()")
    before = drawn()
    buttons[0].click()
    checks.check(drawn() != before and buttons[0].get_attribute("aria-pressed") == "false", f"{name}: a series is hidden")
    buttons[0].click()
    checks.check(buttons[0].get_attribute("aria-pressed") == "true", f"{name}: a series is shown again")


def read_plots(page):
    """The plots of a page by title: {series: (x, y)}."""
    plots = {}
    for text in re.findall(r"^wemsPlot\(\{(.*)\}\);$", page.read_text(), re.M):
        title = json.loads(re.search(r'title:("(?:[^"\\]|\\.)*")', text)[1])
        plots[title] = {}
        for series in re.finditer(r'\{name:("(?:[^"\\]|\\.)*"),[^\[]*x:\[([^\]]*)\],y:\[([^\]]*)\]\}', text):
            x, y = ([float(value) for value in series[i].split(",") if value] for i in (2, 3))
            plots[title][json.loads(series[1])] = (x, y)
    return plots


def distance(cloud, curve):
    """Median distance of the points of a cloud from a curve, over what the curve spans."""
    def on_curve(x):
        at = min(max(bisect.bisect(curve[0], x), 1), len(curve[0]) - 1)
        share = (x - curve[0][at - 1]) / (curve[0][at] - curve[0][at - 1])
        return curve[1][at - 1] + share * (curve[1][at] - curve[1][at - 1])
    span = max(curve[1]) - min(curve[1])
    return statistics.median(abs(y - on_curve(x)) for x, y in zip(*cloud)) / span


def check_diagnosis(browser, page, checks):
    """Before and after: the extended model is the one that the measurement lies on."""
    plots = read_plots(page)
    for axis in (f"{connection}.{letter}" for connection in "1234" for letter in "xyz"):
        curves = plots.get(f"Restoring force at {axis}", {})
        checks.check(sorted(curves) == ["law after", "law before", "measured, after", "measured, before"],
                     f"diagnose: restoring force at {axis}: {sorted(curves)}")
    error = next(plot for title, plot in plots.items() if title.startswith("Error of the free simulation"))
    level = {series: statistics.median(y) for series, (_, y) in error.items()}
    checks.check(level["noise alone"] < 1.5 * level["error after"] < level["error before"] < 3 * level["measured motion"],
                 f"diagnose: medians of the errors: {level}")
    named = re.search(r"The diagnosis names (\d\.[xyz]):", page.read_text())
    checks.check(named, "diagnose: an axis is named")
    if named:
        curves = plots[f"Restoring force at {named[1]}"]
        after = distance(curves["measured, after"], curves["law after"])
        checks.check(after < 0.02, f"diagnose: points are {100 * after:.2f} % off the law after")
        checks.check(f"Force at {named[1]} around its largest motion" in plots, "diagnose: the largest motion is drawn")
        checks.check(sorted(plots[f"Envelope of the motion at {named[1]}"]) == ["after", "before", "measured"],
                     "diagnose: envelope of all three")
        for order in (1, 2, 3):
            for kind in ("Amplitude", "Phase"):
                checks.check(f"{kind} of order {order} at {named[1]}" in plots, f"diagnose: {kind} of order {order}")
    for element in find(browser, ".surface .controls input, .surface .controls select"):
        before = picture_of(browser, ".surface")
        if element.tag_name == "select":
            browser.execute_script(SET, element, 1)
        else:
            element.click()
        two_frames(browser)
        checks.check(picture_of(browser, ".surface") != before,
                     f"diagnose: '{element.accessible_name}' changes the surface")
        if element.tag_name == "select":
            browser.execute_script(SET, element, 0)
        else:
            element.click()
        two_frames(browser)


def main():
    parser = argparse.ArgumentParser()
    for option in ("simulate", "identify", "device", "out"):
        parser.add_argument("--" + option, required=True, type=Path)
    arguments = parser.parse_args()
    browser = start_browser()
    if browser is None:
        return SKIPPED
    checks = Checks()
    try:
        pages = make_reports(arguments.simulate, arguments.identify, arguments.device, arguments.out)
        for page in pages:
            name = page.stem
            checks.check(page.stat().st_size < LARGEST_PAGE, f"{name}: file below 10 MB")
            browser.get(page.as_uri())
            show(browser, WIDTHS[0], False)
            two_frames(browser)
            loaded = browser.execute_script("return performance.getEntriesByType('resource').map(r => r.name)")
            checks.check(not loaded, f"{name}: loads nothing but itself: {loaded}")
            check_names(browser, name, checks)
            if name == TRIED:
                check_zoom(browser, name, checks)
                check_legend(browser, name, checks)
                check_saving(browser, name, arguments.out, checks, read_plots(page))
                check_scene(browser, name, arguments.out, checks)
            titles = [caption.text for caption in find(browser, "figcaption")]
            for title in EXPECTED.get(name, []):
                checks.check(any(text.startswith(title) for text in titles), f"{name}: there is a picture «{title}»")
            if name == "diagnose":
                check_diagnosis(browser, page, checks)
            check_units(browser, name, checks)
            check_page(browser, name, checks, arguments.out)
            check_paper(browser, name, checks, arguments.out)
            errors = [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
            checks.check(not errors, f"{name}: console errors {errors}")
        moving = [page.stem for page in pages if 'class="scene"' in page.read_text()]
        checks.check(moving == ["simulate", "modes", "rigidity", "fit", "diagnose"], f"the device moves in {moving}")
    finally:
        browser.quit()
    print(f"{checks.count} checks, {len(checks.failures)} failed; screenshots in {arguments.out}")
    return 1 if checks.failures else 0


if __name__ == "__main__":
    sys.exit(main())
