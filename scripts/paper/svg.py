"""Line and scatter pictures as SVG text, with the standard library alone."""
import math
from xml.sax.saxutils import escape

COLOURS = ("#1b6ca8", "#d1495b", "#2e7d4f", "#8e5ea2", "#b8860b", "#555555")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 460, 300, 62, 14, 30, 62


def ticks(low, high, count=5):
    """Round numbers that cover [low, high]."""
    raw = (high - low) / count
    power = 10 ** math.floor(math.log10(raw))
    step = min((1, 2, 5, 10), key=lambda s: abs(s * power - raw)) * power
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, int(math.floor(high / step + 1e-9)) + 1)]


def number(value):
    if value != 0 and (abs(value) >= 1e5 or abs(value) < 1e-3):
        return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{value:.6g}"


def thin(x, y, most=700):
    """Keeps the lowest and highest value of each bucket, in order."""
    if len(x) <= 2 * most:
        return list(zip(x, y))
    kept = []
    for b in range(most):
        part = range(b * len(x) // most, (b + 1) * len(x) // most)
        for k in sorted({min(part, key=y.__getitem__), max(part, key=y.__getitem__)}):
            kept.append((x[k], y[k]))
    return kept


def bounds(values, symmetric):
    low, high = min(values), max(values)
    if symmetric:
        high = max(abs(low), abs(high))
        low = -high
    if high - low < 1e-30:
        low, high = low - 1, high + 1
    margin = 0.05 * (high - low)
    return low - margin, high + margin


def frame(title, x_label, y_label, x_range, y_range):
    """Axes and labels; returns SVG parts and the two maps from values to pixels."""
    def px(v):
        return LEFT + (v - x_range[0]) / (x_range[1] - x_range[0]) * (WIDTH - LEFT - RIGHT)

    def py(v):
        return HEIGHT - BOTTOM - (v - y_range[0]) / (y_range[1] - y_range[0]) * (HEIGHT - TOP - BOTTOM)

    parts = [f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
             f'<text x="{WIDTH / 2}" y="18" text-anchor="middle" font-size="13" font-weight="bold">{escape(title)}</text>']
    for v in ticks(*x_range):
        parts.append(f'<line x1="{px(v):.1f}" x2="{px(v):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" stroke="#ddd"/>'
                     f'<text x="{px(v):.1f}" y="{HEIGHT - BOTTOM + 14}" text-anchor="middle">{number(v)}</text>')
    for v in ticks(*y_range):
        parts.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{py(v):.1f}" y2="{py(v):.1f}" stroke="#ddd"/>'
                     f'<text x="{LEFT - 5}" y="{py(v) + 4:.1f}" text-anchor="end">{number(v)}</text>')
    parts.append(f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH - LEFT - RIGHT}" height="{HEIGHT - TOP - BOTTOM}" '
                 'fill="none" stroke="#444"/>')
    parts.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - BOTTOM + 30}" text-anchor="middle">{escape(x_label)}</text>')
    parts.append(f'<text transform="translate(14,{(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">{escape(y_label)}</text>')
    return parts, px, py


def close(parts):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
            'font-family="sans-serif" font-size="11">' + "\n".join(parts) + "</svg>\n")


def plot(title, x_label, y_label, series, symmetric=False):
    """series: (name, x, y) for a line, (name, x, y, "points") for a cloud."""
    x_range = bounds([v for s in series for v in (min(s[1]), max(s[1]))], False)
    y_range = bounds([v for s in series for v in (min(s[2]), max(s[2]))], symmetric)
    parts, px, py = frame(title, x_label, y_label, x_range, y_range)
    for j, entry in enumerate(series):
        name, x, y = entry[:3]
        colour = COLOURS[j % len(COLOURS)]
        if len(entry) > 3:
            stride = max(1, len(x) // 1500)
            dots = "".join(f"M{px(a):.1f} {py(b):.1f}h1.3" for a, b in list(zip(x, y))[::stride])
            parts.append(f'<path d="{dots}" stroke="{colour}" stroke-width="1.3" fill="none"/>')
        else:
            line = " ".join(f"{px(a):.1f},{py(b):.1f}" for a, b in thin(x, y))
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="1.2"/>')
        at = LEFT + j * (WIDTH - LEFT) / max(3, len(series))
        parts.append(f'<rect x="{at}" y="{HEIGHT - 18}" width="10" height="10" fill="{colour}"/>'
                     f'<text x="{at + 14}" y="{HEIGHT - 9}">{escape(name)}</text>')
    return close(parts)


def bars(title, y_label, names, values):
    """Bars on a logarithmic scale from 1."""
    top = max(1.1, math.log10(max(values)))
    parts, _, py = frame(title, "", y_label + ", log10", (0, len(names)), (0, 1.05 * top))
    parts = [p for p in parts if 'y2="%d" stroke="#ddd"' % (HEIGHT - BOTTOM) not in p]
    step = (WIDTH - LEFT - RIGHT) / len(names)
    for j, (name, value) in enumerate(zip(names, values)):
        y = py(max(0.0, math.log10(max(value, 1.0))))
        parts.append(f'<rect x="{LEFT + (j + 0.15) * step:.1f}" y="{y:.1f}" width="{0.7 * step:.1f}" '
                     f'height="{HEIGHT - BOTTOM - y:.1f}" fill="{COLOURS[0]}"/>'
                     f'<text x="{LEFT + (j + 0.5) * step:.1f}" y="{HEIGHT - BOTTOM + 14}" text-anchor="middle">{escape(name)}</text>')
    return close(parts)
