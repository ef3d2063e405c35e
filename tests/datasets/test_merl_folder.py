import hashlib
import threading
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest

from npfm.datasets import merl_folder
from npfm.errors import NpfmError
from npfm.reflectance import merl

HEADER = np.array([90, 90, 180], dtype="<i4").tobytes()
WHOLE = HEADER + bytes(merl.FILE_BYTES - len(HEADER))


class Server(ThreadingHTTPServer):
    """Serves the scripted answers in turn, the last one for ever; counts the requests."""

    def __init__(self, *answers):
        super().__init__(("127.0.0.1", 0), Handler)
        self.answers = answers
        self.paths = []
        self.headers = []
        self.sent = 0

    @property
    def template(self):
        return f"http://127.0.0.1:{self.server_port}/merl/{{name}}.binary"


class Handler(BaseHTTPRequestHandler):
    """An answer is (status, the length that is announced or None, the bytes that are sent)."""

    def do_GET(self):
        turn = len(self.server.paths)
        self.server.paths.append(self.path)
        status, announced, body = self.server.answers[min(turn, len(self.server.answers) - 1)]
        self.send_response(status)
        if announced is not None:
            self.send_header("Content-Length", str(announced))
        for header in self.server.headers:
            self.send_header(*header)
        self.end_headers()
        with suppress(ConnectionError):  # whoever asked has enough
            for begin in range(0, len(body), 2**20):
                self.wfile.write(body[begin : begin + 2**20])
                self.server.sent += min(2**20, len(body) - begin)

    def log_message(self, *args):
        """Keep quiet."""


OK = (200, len(WHOLE), WHOLE)
CUT_OFF = (200, len(WHOLE), WHOLE[:1000])
CUT_OFF_UNANNOUNCED = (200, None, WHOLE[:1000])
WRONG_SIZE = (200, 1000, WHOLE[:1000])
NO_MERL_FILE = (200, 9, b"<html><p>")
TOO_LONG = (200, len(WHOLE) + 1, b"")
ENDLESS = (200, None, WHOLE + bytes(2**26))
NOT_FOUND = (404, 0, b"")
UNAVAILABLE = (503, 0, b"")


@pytest.fixture
def serve(monkeypatch):
    """Start a server on loopback with the given answers."""
    monkeypatch.setattr(merl_folder, "RETRY_WAITS", (0.0, 0.0))
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    servers = []

    def start(*answers):
        server = Server(*answers)
        servers.append(server)
        threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
        return server

    yield start
    for server in servers:
        server.shutdown()
        server.server_close()


def contents(folder):
    return sorted(p.name for p in folder.iterdir())


@pytest.mark.parametrize(
    ("answers", "requests"),
    [([OK], 1), ([CUT_OFF, OK], 2), ([UNAVAILABLE, CUT_OFF_UNANNOUNCED, OK], 3)],
)
def test_a_missing_file_arrives_whole_with_its_checksum(serve, tmp_path, answers, requests):
    server = serve(*answers)
    folder = tmp_path / "merl"
    path = merl_folder.download(server.template, "chrome", folder)
    assert path == folder / "chrome.binary"
    assert path.read_bytes() == WHOLE
    assert server.paths == ["/merl/chrome.binary"] * requests
    record = folder / "chrome.binary.sha256"
    assert record.read_text() == f"{hashlib.sha256(WHOLE).hexdigest()}  chrome.binary\n"
    assert contents(folder) == ["chrome.binary", "chrome.binary.sha256"]
    assert merl_folder.path(folder, "chrome") == path


@pytest.mark.parametrize(
    ("answer", "requests", "reason"),
    [
        (NOT_FOUND, 1, "the server answers 404 Not Found; check the name"),
        (UNAVAILABLE, 3, "download failed 3 times, at last with: 503 Service Unavailable"),
        (CUT_OFF, 3, "download failed 3 times.*IncompleteRead.*check the connection"),
        (CUT_OFF_UNANNOUNCED, 3, "download failed 3 times.*: 1000 bytes, a MERL file has 34992012"),
        (WRONG_SIZE, 3, "download failed 3 times.*: 1000 bytes, a MERL file has 34992012"),
        (NO_MERL_FILE, 3, "download failed 3 times.*: looks like an HTML page, not a MERL"),
        (TOO_LONG, 1, f"the server announces {len(WHOLE) + 1} bytes, a MERL.*check the download"),
        (ENDLESS, 1, "more than the 34992012 bytes of a MERL file arrive; check the download"),
    ],
)
def test_a_download_that_fails_leaves_nothing_and_says_why(
    serve, tmp_path, answer, requests, reason
):
    server = serve(answer)
    url = server.template.format(name="chrome")
    with pytest.raises(NpfmError, match=f"^{url}: {reason}") as caught:
        merl_folder.download(server.template, "chrome", tmp_path)
    assert "\n" not in str(caught.value)
    assert str(tmp_path) not in str(caught.value)
    assert len(server.paths) == requests
    assert contents(tmp_path) == []


def test_no_more_is_taken_than_the_format_has(serve, tmp_path):
    server = serve(ENDLESS)
    with pytest.raises(NpfmError, match="more than the 34992012 bytes"):
        merl_folder.download(server.template, "chrome", tmp_path)
    # The rest is what fits into the buffers of the connection.
    assert server.sent < len(WHOLE) + 2**24
    assert contents(tmp_path) == []


def test_what_a_server_has_packed_is_refused(serve, tmp_path):
    server = serve((200, 3, b"abc"))
    server.headers.append(("Content-Encoding", "gzip"))
    with pytest.raises(NpfmError, match=r"the server sends it packed \(gzip\)"):
        merl_folder.download(server.template, "chrome", tmp_path)
    assert contents(tmp_path) == []


def test_an_unreachable_server_is_named(serve, tmp_path):
    server = serve(OK)
    template = server.template
    server.shutdown()
    server.server_close()
    with pytest.raises(NpfmError, match=r"^http://127.*chrome\.binary: download failed 3 times"):
        merl_folder.download(template, "chrome", tmp_path)
    assert contents(tmp_path) == []


def test_a_file_that_is_there_is_not_fetched_again(serve, tmp_path):
    server = serve(OK)
    (tmp_path / "chrome.binary").write_bytes(b"mine")
    assert merl_folder.download(server.template, "chrome", tmp_path).read_bytes() == b"mine"
    assert server.paths == []


@pytest.mark.parametrize("template", ["https://host/chrome.binary", "host/{name}.binary"])
def test_an_address_that_cannot_work_is_refused(tmp_path, template):
    with pytest.raises(NpfmError, match="a download address begins with http"):
        merl_folder.download(template, "chrome", tmp_path)


def test_materials_are_the_finished_binary_files(tmp_path):
    for name in ("pvc.binary", "chrome.binary", ".nylon.0123.binary", "pvc.binary.sha256", "a.txt"):
        (tmp_path / name).touch()
    assert merl_folder.materials(tmp_path) == ["chrome", "pvc"]


def test_a_material_is_not_missed_for_its_suffix(tmp_path):
    (tmp_path / "chrome.BINARY").touch()
    with pytest.raises(NpfmError, match=r"chrome\.BINARY: rename it to chrome\.binary"):
        merl_folder.materials(tmp_path)


def test_an_absent_folder_is_named(tmp_path):
    with pytest.raises(NpfmError, match="nowhere: no such folder"):
        merl_folder.materials(tmp_path / "nowhere")


def test_a_missing_file_is_answered_with_the_nearest_names(tmp_path):
    (tmp_path / "chrome.binary").touch()
    with pytest.raises(NpfmError, match=r"crome\.binary: no such file; did you mean chrome\?"):
        merl_folder.path(tmp_path, "crome")


def test_a_damaged_file_is_refused(tmp_path):
    (tmp_path / "chrome.binary").write_bytes(WHOLE[:5000])
    with pytest.raises(NpfmError, match=r"chrome\.binary: 5000 bytes"):
        merl_folder.path(tmp_path, "chrome")
