"""Runs everything and writes build/paper/paper.html and paper.md: see scripts/reproduce_paper."""
import content
import figures
import svg
import work
from page import Page


def main():
    fits = work.run_all()
    figures.save_results(fits)
    results = content.Results(fits)
    page = Page("The paper's tables and figures, and ours")
    page.text("Noël, Kerschen, Newerla, “Application of the Restoring Force Surface Method to a Real-life Spacecraft Structure”, IMAC XXX, 2012. Every value of ours comes from recordings that `simulate` wrote as CSV "
              "and `identify` read back. Our device has the paper's ratios of stiffness and clearance and its regimes, not its structure: the paper's is confidential.")
    content.summary(page, results)
    figures.beam(page, svg)
    figures.rigidity(page, svg)
    content.axial_linear(page, results, svg)
    content.qualitative(page, results, svg)
    figures.nonlinear(page, results, svg)
    content.lateral(page, results)
    content.lateral_pictures(page, results, svg)
    content.damping(page, results)
    content.other_channels(page, results)
    page.write(work.OUT)
    print(f"{work.OUT}/paper.html and paper.md with its pictures")


if __name__ == "__main__":
    main()
