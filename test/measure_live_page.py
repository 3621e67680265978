"""Measure the live page in a browser: its size, its first picture, a picture, a change of a slider.

.venv/bin/python test/measure_live_page.py
"""

import os
import shutil
import statistics
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path[:0] = [str(Path(__file__).resolve().parent)]
os.environ.setdefault("SPINTOP_BROWSER", shutil.which("chromium") or "")

from browser_case import BROWSER, SOFTWARE_WEBGL, open_browser, wait_for  # noqa: E402
from reporting.packages import need  # noqa: E402
from reporting.page import make_alone, write_page  # noqa: E402

FRAMES = 120

TIMES = """
    const [name, count, step, done] = arguments, times = [];
    const { section } = liveTop;
    section.addEventListener(name, ({ detail }) => {
        times.push(detail);
        if (times.length === count) done(times);
        else if (step) requestAnimationFrame(change);
    });
    const { slider } = liveTop.controls.omega3;
    const change = () => {
        slider.value = Number(slider.max) / 4 + step * times.length;
        slider.dispatchEvent(new Event("input"));
    };
    if (step) change(); else liveTop.clock.play();
"""
"""How long the script took for each of so many events, in ms."""

AXE = """
    const done = arguments[0];
    axe.run().then(({ violations }) => done(violations.map((one) => one.id)));
"""

FIRST = """
    const paints = performance.getEntriesByType("paint");
    return paints.find(({ name }) => name === "first-contentful-paint")?.startTime;
"""


NOTE_TOP = """
    addEventListener("frame", () => {
        if (document.querySelector(".stage canvas")) globalThis.topDrawn ??= performance.now();
    }, true);
"""
"""Notes when the top has been drawn, which comes after panel and charts."""

DRAWN = "return globalThis.topDrawn"


def report(words: str, times: list[float]) -> None:
    """Print the least and the median of times."""
    print(f"{words}: {min(times):.1f} ms at least, {statistics.median(times):.1f} ms in the median")


def main() -> int:
    """Print what was measured."""
    if not BROWSER:
        print("no browser: chromium is not installed", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        page = Path(scratch) / "live.html"
        write_page(make_alone("--live"), page)
        browser = open_browser(Path(scratch) / "profile", *SOFTWARE_WEBGL)
        try:
            print(f"page: {page.stat().st_size / 1e6:.2f} MB")
            note = "Page.addScriptToEvaluateOnNewDocument"
            browser.execute_cdp_cmd(note, {"source": NOTE_TOP})
            painted, drawn = [], []
            for _ in range(5):
                browser.get(page.as_uri())
                painted.append(wait_for(lambda: browser.execute_script(FIRST), "a picture"))
                drawn.append(wait_for(lambda: browser.execute_script(DRAWN), "a top"))
            report("first picture", painted)
            report("first picture of the top", drawn)
            frames = browser.execute_async_script(TIMES, "frame", FRAMES, 0)
            report("script of a picture", frames)
            changes = browser.execute_async_script(TIMES, "computed", FRAMES, 1)
            report("recomputation after a change of the spin", changes)
            axe = (need("axe-core") / "axe.min.js").read_text(encoding="utf-8")
            browser.execute_cdp_cmd("Runtime.evaluate", {"expression": axe})
            print(f"axe: {len(browser.execute_async_script(AXE))} violations")
            severe = [e for e in browser.get_log("browser") if e["level"] == "SEVERE"]
            print(f"console: {len(severe)} errors")
        finally:
            browser.quit()
    return 0


if __name__ == "__main__":
    sys.exit(main())
