# SPDX-License-Identifier: GPL-3.0-or-later
"""A page in a real browser, Debian's chromium, without a network: what a script finds in it."""

import http.server
import json
import shutil
import subprocess
import tempfile
import threading
from pathlib import Path

CHROMIUM = shutil.which("chromium")
_FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
)
_BEFORE = """<script>
window.said = [];
for (const kind of ["error", "warn"]) console[kind] = (...words) => said.push(words.join(" "));
addEventListener("error", event => said.push(String(event.message)));
addEventListener("unhandledrejection", event => said.push(String(event.reason)));
</script>"""
_AFTER = """<script>
(async () => {
  while (!document.documentElement.dataset.ready) await new Promise(done => setTimeout(done, 20));
  let answer;
  try { answer = await (async () => { %s })(); } catch (error) { said.push(String(error.stack)); }
  const body = JSON.stringify({answer, said});
  await fetch("http://127.0.0.1:%d/", {method: "POST", mode: "no-cors", body});
})();
</script>"""


def browse(page, script, folder, size=(1200, 800), view=""):
    """(what the script returns once the page is ready, what the console was told). view: after the # of the
    address."""
    answers, has_answer = [], threading.Event()

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_POST(self):
            answers.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()
            has_answer.set()

        def log_message(self, *_words):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    file = Path(folder) / "tried.html"
    after = _AFTER % (script, server.server_address[1])
    file.write_text(page.replace("<head>", f"<head>{_BEFORE}", 1) + after, encoding="utf-8")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        width, height = size
        command = [CHROMIUM, *_FLAGS, f"--user-data-dir={profile}", f"--window-size={width},{height}"]
        process = subprocess.Popen(
            [*command, f"{file.as_uri()}{view}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            assert has_answer.wait(300), "the page gave no answer within five minutes"
        finally:
            process.terminate()
            process.wait()
            server.shutdown()
            server.server_close()
    return answers[0].get("answer"), answers[0]["said"]
