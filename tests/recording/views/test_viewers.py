"""Recordings in a browser and side by side in one viewer: served offline, shown in real Chromium, ended cleanly."""

import contextlib
import io
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from dataclasses import replace
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from sailviz.cli import main
from sailviz.errors import RecordingError
from sailviz.recording import record
from sailviz.recording.drawing.style import TARGET
from sailviz.recording.sinks import viewer_binary
from sailviz.recording.views.screenshot import has_vulkan
from sailviz.recording.views.viewers import WebServer, open_viewer
from sailviz.recording.views.web_folder import write_web_folder
from sailviz.recording.web_page import free_port

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
PATIENCE = 75.0  # s for a browser without a graphics card
FLAGS = """headless=new no-sandbox use-gl=angle use-angle=swiftshader enable-unsafe-swiftshader ignore-gpu-blocklist
    disable-background-networking disable-component-update disable-sync no-first-run window-size=480,270"""
OFFLINE = "MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"
RUN_FOR_BROWSER = """
import sys
from sailviz.cli import main
from sailviz.recording import sinks
from sailviz.recording.web_page import free_port
import sailviz.recording
sinks.WEB = sinks.Web(free_port(), free_port(), open_browser=False)  # ports that nobody has
sailviz.recording.WEB = sinks.WEB
main(sys.argv[1:])
"""


def end(process):
    """Leave nothing behind, whatever became of the test."""
    process.kill()
    process.wait()


@pytest.fixture
def recorded(run, tmp_path):
    path = tmp_path / "run.rrd"
    record(run, path)
    return path


def answers(url):
    address = urlsplit(url)
    with contextlib.suppress(OSError), socket.create_connection((address.hostname, address.port), timeout=1):
        return True
    return False


def test_the_page_and_its_viewer_come_from_this_machine_and_end_with_the_server(recorded):
    with WebServer(recorded) as server:
        page = urllib.request.urlopen(server.url).read().decode()
        wasm = urllib.request.urlopen(server.url.split("?")[0] + "re_viewer_bg.wasm").read(4)
        data = parse_qs(urlsplit(server.url).query)["url"][0].removeprefix("rerun+")
        assert "the_canvas_id" in page
        assert wasm == b"\0asm"
        assert answers(server.url)
        assert answers(data)
    assert not answers(server.url)
    assert not answers(data)


def test_a_taken_port_and_a_file_that_is_no_recording_are_refused(recorded, tmp_path):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with (
            pytest.raises(RecordingError, match="cannot listen on 127"),
            WebServer(recorded, port=taken.getsockname()[1]),
        ):
            pass
    (tmp_path / "words.rrd").write_text("words, words")
    result = CliRunner().invoke(main, ["web", str(tmp_path / "words.rrd"), "--no-open"])
    assert result.exit_code == 2
    assert "not a Rerun recording" in result.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_the_command_serves_until_it_is_told_to_end_and_leaves_no_process(recorded, how):
    words = [sys.executable, "-m", "sailviz", "web", str(recorded), "--no-open"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        url = process.stdout.readline().strip()
        assert answers(url)
        process.send_signal(how)
        assert process.wait(20) == 0
        assert not answers(url)
    finally:
        end(process)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="screens are found by name on Linux only")
def test_without_a_screen_the_native_viewer_is_not_started(recorded, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(RecordingError, match="no screen for the viewer: `sailviz web`"):
        open_viewer(recorded)


@pytest.mark.skipif(not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
def test_recordings_of_two_families_in_one_viewer_keep_their_layouts(runs, tmp_path):
    from rerun.experimental import ViewerClient

    paths = [tmp_path / "displaced.rrd", tmp_path / "deorbit.rrd"]
    for path, one in zip(paths, (runs.displaced(), runs.descent()), strict=True):
        record(one, path)
    port = free_port()
    command = [viewer_binary(), "--headless", "--bind", "127.0.0.1", "--port", str(port), *map(str, paths)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def asked_until(question, patience=30.0):
        started, answer = time.monotonic(), None
        while not answer and time.monotonic() - started < patience:
            with contextlib.suppress(Exception):  # not up yet
                answer = question()
            time.sleep(0.1)
        return answer

    try:
        viewer = asked_until(lambda: ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy"))
        known = asked_until(lambda: len(s := viewer.get_state().recordings) == 2 and s)
        shown = {}
        for recording in known:
            viewer.set_location(recording.location)

            def views(store=recording.store_id):
                state = viewer.get_state()
                return state.active_recording == store and {view.name.split(" ")[0] for view in state.views}

            shown[recording.store_id] = asked_until(views)
            again = viewer.get_blueprint(store_id=recording.store_id).blueprint
            assert sum("ViewBlueprint" in part for part in again.values()) == len(viewer.get_state().views)
        system, earth = sorted(shown.values(), key=lambda names: "Where" in names)
        assert {"Flight", "E-sail"} <= system
        assert {"Riding", "Where", "Altitude"} <= earth
        assert not {"Where", "Altitude"} & system
    finally:
        end(process)


def chromium():
    """A browser without a graphics card and without the internet."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="the extra test brings selenium")
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for flag in FLAGS.split():
        options.add_argument(f"--{flag}")
    options.add_argument(f"--host-resolver-rules={OFFLINE}")
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    driver.set_page_load_timeout(60)
    return driver


class Remembering(SimpleHTTPRequestHandler):
    """A plain web server that remembers what it was asked for."""

    def log_message(self, *_):
        self.server.asked.append(urlsplit(self.path).path)


@contextlib.contextmanager
def handed_out(path):
    """A folder with the page, and a plain web server for it: its url, and the paths that were asked for."""
    folder = path.parent / "site"
    assert CliRunner().invoke(main, ["web", str(path), "--export", str(folder)]).exit_code == 0
    handler = partial(Remembering, directory=folder)
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        server.asked = []
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield SimpleNamespace(url=f"http://127.0.0.1:{server.server_port}/", asked=server.asked)
        finally:
            server.shutdown()
            thread.join()


def looks(browser):
    """(n, 3) int colours of the page, and how many of them are different."""
    pixels = np.asarray(Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("RGB"), int).reshape(-1, 3)
    return pixels, len(np.unique(pixels, axis=0))


@pytest.mark.skipif(not (BROWSER and DRIVER), reason="no Chromium: apt-get install chromium chromium-driver")
def test_chromium_shows_a_recording_without_the_internet(recorded):
    browser = chromium()
    try:
        with WebServer(recorded) as server:
            browser.get(f"{server.url}&renderer=webgl")
            started, orbit = time.monotonic(), 0.0
            while orbit < 5e-4 and time.monotonic() - started < PATIENCE:
                time.sleep(0.5)
                pixels, colours = looks(browser)
                orbit = np.mean(np.abs(pixels - TARGET).max(axis=1) < 30)
            assert browser.find_elements("id", "the_canvas_id")
            assert pixels.std() > 10
            assert colours > 500
            assert orbit >= 5e-4, "the designed orbit is not in the picture"
    finally:
        browser.quit()


@pytest.mark.skipif(not (BROWSER and DRIVER), reason="no Chromium: apt-get install chromium chromium-driver")
def test_chromium_opens_an_exported_folder_without_the_internet(recorded):
    """The viewer in the page starts and asks for the recording; that it then draws it is seen above."""
    browser = chromium()
    try:
        with handed_out(recorded) as server:
            browser.get(f"{server.url}?renderer=webgl")
            started = time.monotonic()
            while f"/{recorded.name}" not in server.asked and time.monotonic() - started < PATIENCE:
                time.sleep(0.2)
            assert f"/{recorded.name}" in server.asked
            browser.switch_to.frame(browser.find_element("tag name", "iframe"))
            assert browser.find_elements("id", "the_canvas_id")
    finally:
        browser.quit()


def test_the_exported_folder_asks_no_foreign_server_and_keeps_titles_as_text(run, tmp_path):
    for name, title in (("a <b>.rrd", "</title><script>alert(1)</script>"), ("c.rrd", "Calm")):
        record(replace(run, setting=replace(run.setting, title=title)), tmp_path / name)
    written = write_web_folder([tmp_path / "a <b>.rrd", tmp_path / "c.rrd"], tmp_path / "site")
    page = (tmp_path / "site" / "index.html").read_text()
    assert "<script>alert" not in page
    assert '["a \\u003cb>.rrd", "c.rrd"]' in page
    viewer = (tmp_path / "site" / "viewer" / "index.html").read_text()
    assert not re.search(r"""(src|href)=["']?https?://(?!github)""", viewer)
    assert "script.src" not in viewer
    assert written.recordings == ("a <b>.rrd", "c.rrd")
    assert written.size == sum(path.stat().st_size for path in (tmp_path / "site").rglob("*") if path.is_file())
    for name in written.recordings:
        assert (tmp_path / "site" / name).read_bytes() == (tmp_path / name).read_bytes()


def test_what_cannot_be_exported_is_refused_before_anything_is_written(recorded, tmp_path):
    (tmp_path / "words.rrd").write_text("words, words")
    (tmp_path / "other").mkdir()
    shutil.copy(recorded, tmp_path / "other" / recorded.name)
    site = tmp_path / "site"
    for files, words in (
        ([tmp_path / "words.rrd"], "not a Rerun recording"),
        ([recorded, tmp_path / "other" / recorded.name, "--apart"], "have the same name, run.rrd"),
    ):
        result = CliRunner().invoke(main, ["web", *map(str, files), "--export", str(site)])
        assert result.exit_code == 2
        assert words in result.stderr
        assert not site.exists()
    file = CliRunner().invoke(main, ["web", str(recorded), "--export", str(tmp_path / "words.rrd")])
    assert file.exit_code == 2
    assert "it is no folder" in file.stderr


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_a_run_for_the_browser_is_served_to_this_machine_alone(tmp_path):
    """Every socket that listens, of the command and of what it started, stands on 127.0.0.1."""
    words = ["run", "displaced/circular", "--web", "-q", "--set", "propagation.outputs=20", "--set", "expect=[]"]
    process = subprocess.Popen(
        [sys.executable, "-c", RUN_FOR_BROWSER, *words], stderr=subprocess.PIPE, text=True, cwd=tmp_path
    )
    try:
        url = next(word for line in process.stderr for word in line.split() if word.startswith("http://"))
        assert answers(url)
        page = int(url.split(":")[2].split("/")[0])
        listening = [line.split() for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
        where = {row[1].split(":")[0] for row in listening if row[3] == "0A" and int(row[1].split(":")[1], 16) == page}
        assert where == {"0100007F"}
        process.send_signal(signal.SIGTERM)
        assert process.wait(20) == 0
        assert not answers(url)
    finally:
        end(process)
