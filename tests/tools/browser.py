"""Controls a headless Chromium (Debian: chromium) by Chrome's DevTools protocol over a pipe. Uses only Python's standard library."""
import json, os, select, shutil, subprocess, tempfile, time

PROGRAMS = ["chromium", "chromium-browser", "google-chrome"]
TIMEOUT_S = 60  # maximum time until the browser answers


def program():
    """Returns the path of the browser; None if no browser is installed."""
    return next((path for path in map(shutil.which, PROGRAMS) if path), None)


class Browser:
    """One page in one browser. `events`: [(method, parameters)] of the events received so far."""

    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="raya-browser-")
        command_end, self.commands = os.pipe()  # the browser reads commands from fd 3 and writes answers to fd 4
        self.answers, answer_end = os.pipe()

        def take_pipes():  # runs in the child process, before the browser starts
            ends = os.dup(command_end), os.dup(answer_end)  # duplicates, whose numbers are not 3 and 4
            os.dup2(ends[0], 3), os.dup2(ends[1], 4)

        self.process = subprocess.Popen(
            [program(), "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars",
             "--disable-background-networking", "--disable-component-update", "--remote-debugging-pipe", f"--user-data-dir={self.profile}"],
            preexec_fn=take_pipes, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(command_end), os.close(answer_end)
        self.unparsed, self.command_id, self.events, self.session = b"", 0, [], None
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for part in ("Page", "Network", "Runtime", "Log", "Accessibility"):
            self.ask(part + ".enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        os.close(self.commands), os.close(self.answers)
        shutil.rmtree(self.profile, ignore_errors=True)

    def message(self, seconds):
        """Returns the browser's next message; None if no message arrives within `seconds`."""
        end = time.monotonic() + seconds
        while b"\0" not in self.unparsed:
            if not select.select([self.answers], [], [], max(0, end - time.monotonic()))[0]:
                return None
            piece = os.read(self.answers, 1 << 16)
            if not piece:
                raise RuntimeError("the browser has exited")
            self.unparsed += piece
        text, self.unparsed = self.unparsed.split(b"\0", 1)
        return json.loads(text)

    def ask(self, method, **parameters):
        """Sends a command and returns its result. Raises RuntimeError if the browser reports an error or does not answer."""
        self.command_id += 1
        command = {"id": self.command_id, "method": method, "params": parameters}
        if self.session:
            command["sessionId"] = self.session
        data = json.dumps(command).encode() + b"\0"
        while data:
            data = data[os.write(self.commands, data):]
        while True:
            answer = self.message(TIMEOUT_S)
            if answer is None:
                raise RuntimeError(f"no answer to {method}")
            if answer.get("id") == self.command_id:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            if "method" in answer:
                self.events.append((answer["method"], answer.get("params", {})))

    def wait_for(self, method):
        """Waits for the event `method`. Raises RuntimeError after TIMEOUT_S."""
        while not any(name == method for name, _ in self.events):
            message = self.message(TIMEOUT_S)
            if message is None:
                raise RuntimeError(f"the browser did not send {method} within {TIMEOUT_S} s")
            if "method" in message:
                self.events.append((message["method"], message.get("params", {})))

    def open(self, url, width=1000, dark=False, scripts=True, media=""):
        """Loads a page and clears the events."""
        self.ask("Emulation.setScriptExecutionDisabled", value=not scripts)
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        self.ask("Emulation.setEmulatedMedia", media=media,
                 features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.events.clear()
        self.ask("Page.navigate", url=url)
        self.wait_for("Page.loadEventFired")

    def value(self, expression):
        """Returns the value of a JavaScript expression in the page."""
        answer = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(json.dumps(answer["exceptionDetails"])[:600])
        return answer["result"].get("value")

    def picture(self, file, max_height=12000):
        """Writes a screenshot of the page, cut to `max_height` pixels because Chromium refuses higher screenshots."""
        import base64
        width, height = self.value("[innerWidth, document.documentElement.scrollHeight]")
        clip = {"x": 0, "y": 0, "width": width, "height": min(height, max_height), "scale": 1}
        data = self.ask("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)["data"]
        with open(file, "wb") as out:
            out.write(base64.b64decode(data))
