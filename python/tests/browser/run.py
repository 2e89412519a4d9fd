"""Turns a million spheres in JupyterLab in Chromium: frames per second, input to picture.

By hand: python run.py FOLDER (for screenshots). Needs jupyterlab, anywidget, playwright and
Chromium, which CHROMIUM names (default: /usr/bin/chromium).
"""

import json
import os
import pathlib
import subprocess
import sys
import time
import urllib.request

from playwright.sync_api import sync_playwright

CODE = """import numpy as np, raio
random = np.random.default_rng(1)
scene = raio.Scene()
_ = scene.spheres(random.uniform(-5, 5, (1_000_000, 3)).astype(np.float32), 0.05,
                  colors=random.uniform(0, 1, (1_000_000, 3)).astype(np.float32))
scene.view()"""
PORT = 8931

# Notes the time of each frame, as soon as it is drawn.
WATCH = """canvas => {
  window.frames_seen = [];
  new MutationObserver(() => window.frames_seen.push(
      [performance.now(), Number(canvas.dataset.frame), Number(canvas.dataset.samples)]))
    .observe(canvas, {attributes: true, attributeFilter: ["data-frame"]});
}"""


# The mouse's events, made in the page: the driver's own take long on a busy machine.
MOVE = """(canvas, [x, y]) => {
  const state = [performance.now(), window.frames_seen.length];
  canvas.dispatchEvent(new PointerEvent("pointermove", {clientX: x, clientY: y, bubbles: true}));
  return state;
}"""
DRAG = """(canvas, [x, y]) => {
  let i = 0;
  window.dragging = setInterval(() => {
    const where = {clientX: x + 2 * ++i, clientY: y + 60 * Math.sin(i / 50), bubbles: true};
    canvas.dispatchEvent(new PointerEvent("pointermove", where));
  }, 16);
  return [performance.now(), window.frames_seen.length];
}"""


def notebook(path):
    cell = {"cell_type": "code", "id": "a", "execution_count": None, "metadata": {}, "outputs": [],
            "source": CODE}
    path.write_text(json.dumps({"cells": [cell], "nbformat": 4, "nbformat_minor": 5, "metadata": {
        "kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}}))


def wait_for_server():
    for _ in range(120):
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{PORT}/api", timeout=1)
            return
        except OSError:
            time.sleep(0.5)
    raise SystemExit("JupyterLab did not start")


def measure(page, canvas, folder):
    box = canvas.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.wait_for_function("c => Number(c.dataset.samples) >= 64", arg=canvas, timeout=120_000)
    page.screenshot(path=folder / "1-still.png")
    canvas.evaluate(WATCH)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 10, y)
    # Single steps: from the input to the first picture that moves.
    delays = []
    for i in range(10):
        page.wait_for_timeout(700 + 37 * i)
        start, seen = canvas.evaluate(MOVE, [x + 20 + 10 * i, y])
        page.wait_for_function("n => window.frames_seen.slice(n).some(f => f[2] === 0)", arg=seen)
        frames = page.evaluate("n => window.frames_seen.slice(n)", seen)
        delays.append(next(f[0] for f in frames if f[2] == 0) - start)
    # One long drag.
    start, seen = canvas.evaluate(DRAG, [x + 120, y])
    page.wait_for_timeout(6000)
    now = page.evaluate("performance.now()")
    frames = page.evaluate("n => window.frames_seen.slice(n)", seen)
    page.screenshot(path=folder / "2-turning.png")
    page.evaluate("clearInterval(window.dragging)")
    page.mouse.up()
    page.wait_for_function("c => Number(c.dataset.samples) >= 64", arg=canvas, timeout=120_000)
    page.screenshot(path=folder / "3-turned.png")
    for _ in range(8):
        page.mouse.wheel(0, -120)
        page.wait_for_timeout(60)
    page.wait_for_timeout(600)
    page.wait_for_function("c => Number(c.dataset.samples) >= 64", arg=canvas, timeout=120_000)
    page.screenshot(path=folder / "4-near.png")
    page.mouse.dblclick(x, y)
    page.wait_for_timeout(600)
    page.wait_for_function("c => Number(c.dataset.samples) >= 64", arg=canvas, timeout=120_000)
    page.screenshot(path=folder / "5-reset.png")
    delays.sort()
    print(f"{1000 * len(frames) / (now - start):.1f} frames/s; input to picture: median "
          f"{delays[len(delays) // 2]:.0f} ms, worst {delays[-1]:.0f} ms; load "
          f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    notebook(folder / "view.ipynb")
    server = subprocess.Popen(
        [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", f"--port={PORT}",
         "--IdentityProvider.token=", "--ServerApp.disable_check_xsrf=True",
         f"--ServerApp.root_dir={folder}"], stderr=open(folder / "server.log", "w"))
    try:
        wait_for_server()
        with sync_playwright() as play:
            browser = play.chromium.launch(
                executable_path=os.environ.get("CHROMIUM", "/usr/bin/chromium"),
                args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1100, "height": 900})
            page.goto(f"http://127.0.0.1:{PORT}/lab/tree/view.ipynb")
            page.locator(".jp-Notebook .jp-CodeCell").first.click(timeout=60_000)
            page.keyboard.press("Control+Enter")
            try:
                canvas = page.wait_for_selector(".raio-view canvas", timeout=90_000)
                measure(page, canvas, folder)
            except Exception:
                page.screenshot(path=folder / "failure.png")
                raise
            browser.close()
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    main()
