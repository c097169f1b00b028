# SPDX-License-Identifier: Apache-2.0
"""Chromium without a window, told what to do over a pipe (the DevTools protocol), with nothing else installed."""
import base64, json, os, shutil, subprocess, tempfile, time
from pathlib import Path

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--remote-debugging-pipe", "--no-first-run", "--disable-background-networking", "--disable-dev-shm-usage"]
SECONDS = 120


def program():
    return next((path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None)


class Browser:
    """One page of a browser. `events` has all that it told of, in order."""

    def __init__(self, width=1200, height=800):
        self.folder = tempfile.mkdtemp(prefix="browser-")
        read, told = os.pipe()
        answers, write = os.pipe()
        # The browser reads its descriptor 3 and writes to 4.
        script = f'exec 3<&{read} 4>&{write}; exec "$0" "$@"'
        self.process = subprocess.Popen(
            ["sh", "-c", script, program(), *FLAGS, f"--user-data-dir={self.folder}", f"--window-size={width},{height}"],
            pass_fds=(read, write), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(read)
        os.close(write)
        self.told, self.answers = told, answers
        self.rest, self.number, self.events, self.session = b"", 0, [], None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Network", "Runtime", "Log"):
            self.call(domain + ".enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        os.close(self.told)
        os.close(self.answers)
        shutil.rmtree(self.folder, ignore_errors=True)

    def message(self):
        while b"\0" not in self.rest:
            got = os.read(self.answers, 1 << 20)
            if not got:
                raise RuntimeError("the browser ended")
            self.rest += got
        text, self.rest = self.rest.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.told, json.dumps(request).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def value(self, expression):
        """What a script's expression is, in the page."""
        got = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in got:
            raise RuntimeError(f"{expression}: {got['exceptionDetails']}")
        return got["result"].get("value")

    def open(self, path, fragment=""):
        """Opens a page and waits until it is drawn. Returns the milliseconds that took, as the page tells."""
        self.events.clear()
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=Path(path).resolve().as_uri() + fragment)
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            ready = self.value("document.body && document.body.dataset.ready || ''")
            if ready:
                return ready
            time.sleep(0.05)
        raise RuntimeError(f"{path}: not drawn after {SECONDS} s")

    def screenshot(self, path=None):
        data = self.call("Page.captureScreenshot", format="png")["data"]
        if path:
            Path(path).write_bytes(base64.b64decode(data))
        return data

    def click(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key)

    def told_of(self, method):
        self.value("0")  # so that all events before have come
        return [event["params"] for event in self.events if event.get("method") == method]
