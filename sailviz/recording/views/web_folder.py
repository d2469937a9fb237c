"""A folder of static files that shows recordings wherever a web server hands it out: viewer, recordings, one page.

The viewer is Rerun's own for browsers, taken from the installed package (licence MIT or Apache-2.0), without the
links to foreign servers that its page carries; nothing in the folder asks anybody but the server that it came from.
"""

from __future__ import annotations

import html
import json
import re
import shutil
import urllib.request
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.recording.children import Child
from sailviz.recording.reader import FilePath, read
from sailviz.recording.sinks import viewer_binary
from sailviz.recording.web_page import HOST, free_port, viewer_environment, wait_for_page

VIEWER = "viewer"  # the folder of Rerun's files
VIEWER_FILES = ("index.html", "re_viewer.js", "re_viewer_bg.wasm", "favicon.ico")
FOREIGN_LINK = re.compile(r"<link\b[^>]*https?://[^>]*>\s*", re.IGNORECASE)
FOREIGN_SCRIPT = re.compile(r'if \(window\.location\.hostname == "app\.rerun\.io"\) \{.*?\n      \}\n', re.DOTALL)
PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>@TITLE@</title>
<link rel="icon" href="viewer/favicon.ico">
<style>
html, body { height: 100%; margin: 0; background: #0d1011; color: #cad8de; font-family: sans-serif; }
iframe { border: 0; width: 100%; height: 100%; display: block; }
p { padding: 2em; max-width: 45em; }
</style>
</head>
<body>
<noscript><p>@TITLE@: the viewer needs JavaScript.</p></noscript>
<script>
const recordings = @RECORDINGS@;
if (location.protocol === "file:") {
  const hint = document.createElement("p");
  hint.textContent = "A browser shows these flights from a web server only. One for this machine: " +
    "python -m http.server --bind 127.0.0.1 in this folder, then open http://127.0.0.1:8000/";
  document.body.append(hint);
} else {
  const query = new URLSearchParams(location.search);
  for (const name of recordings) query.append("url", new URL(encodeURIComponent(name), location.href).href);
  query.set("hide_welcome_screen", "1");
  query.set("persist", "0");
  if (!query.has("theme")) query.set("theme", "dark");
  const frame = document.createElement("iframe");
  frame.title = document.title;
  frame.allow = "fullscreen";
  frame.src = "viewer/index.html?" + query;
  document.body.append(frame);
}
</script>
</body>
</html>
"""


@dataclass(frozen=True)
class WebFolder:
    """What was written. folder : its place; recordings : their names in it; size : of everything, bytes."""

    folder: Path
    recordings: tuple[str, ...]
    size: int


def write_web_folder(paths: Sequence[FilePath], folder: FilePath) -> WebFolder:
    """Write what a web server needs to show recordings: `index.html`, the recordings, and `viewer/` with Rerun's.

    paths : of the recordings, shown in one viewer, the first in front. folder : made where there is none; files of
    these names in it are replaced, each whole or not at all, and the page last. Raises RecordingError where a file is
    no recording or two have one name, OutputError where something cannot be written.
    """
    sources = [Path(path) for path in paths]
    titles = [read(path).title for path in sources]  # says in one sentence what cannot be shown
    names = [f"{path.stem}.rrd" for path in sources]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        raise RecordingError(f"two recordings have the same name, {twice}: they would be one file in the folder")
    place = Path(folder)
    try:
        (place / VIEWER).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise files.OutputError(f"cannot make the folder {place / VIEWER}: {files.reason(error)}") from None
    for name, content in _viewer_files().items():
        with files.writing(place / VIEWER / name, "page") as part:
            part.write_bytes(content)
    for name, source in zip(names, sources, strict=True):
        target = place / name
        if not (target.exists() and target.samefile(source)):
            with files.writing(target, "recording") as part:
                shutil.copyfile(source, part)
    files.write_text(place / "index.html", _page(titles, names), "page")
    written = [place / "index.html", *(place / VIEWER / name for name in VIEWER_FILES), *(place / n for n in names)]
    return WebFolder(place, tuple(names), sum(path.stat().st_size for path in written))


def _page(titles: Sequence[str], names: Sequence[str]) -> str:
    """The page that opens the viewer on the recordings. Whatever people wrote in their titles stays text."""
    title = html.escape(", ".join(dict.fromkeys(title for title in titles if title)) or ", ".join(names))
    listed = json.dumps(list(names)).replace("<", "\\u003c")
    return re.sub("@TITLE@|@RECORDINGS@", lambda m: title if m[0] == "@TITLE@" else listed, PAGE)


def _viewer_files() -> dict[str, bytes]:
    """The files of Rerun's viewer for browsers, as its own server hands them out on this machine."""
    port = free_port()
    command = [viewer_binary(), "--serve-web", "--bind", HOST, "--port", str(free_port())]
    process = Child([*command, "--web-viewer-port", str(port)], viewer_environment())
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    try:
        wait_for_page(process, HOST, port)
        found = {name: opener.open(f"http://{HOST}:{port}/{name}", timeout=30).read() for name in VIEWER_FILES}
    except OSError as error:
        raise RecordingError(f"the viewer for browsers could not be taken from its package: {error}") from None
    finally:
        process.end()
    found["index.html"] = _without_foreign_links(found["index.html"].decode()).encode()
    return found


def _without_foreign_links(page: str) -> str:
    return FOREIGN_SCRIPT.sub("", FOREIGN_LINK.sub("", page))
