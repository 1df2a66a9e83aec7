"""How the sweep and the soak talk to a session: HTTP, WebSocket, datagrams; and what they ask of
everything that comes back: docs/viewer-protocol.md and docs/devices.md, and no number that is none.
"""
import base64
import json
import os
import re
import socket
import struct
import subprocess
import time

# What a server may close with.
CLOSES = {1001, 1002, 1003, 1007, 1008, 1009, 4001, 4002, 4003}


class Wrong(Exception):
    """The other side has broken its own rules."""


class Gone(Exception):
    """The other side has closed."""


def no_number(text):
    raise Wrong(f"a number that is none: {text}")


def strict_json(text):
    """JSON without NaN and infinities, which Python would read."""
    return json.loads(text, parse_constant=no_number)


def check_floats(data, what):
    """No word of these is an infinity or no number: all exponent bits set."""
    for (word,) in struct.iter_unpack("<I", data):
        if word & 0x7F800000 == 0x7F800000:
            raise Wrong(f"{what}: a number that is none")


def check_binary(data):
    """A binary message: as long as its counts say, and finite. Returns its kind."""
    if len(data) < 16 or len(data) % 4:
        raise Wrong(f"a binary message of {len(data)} bytes")
    kind, first, second, third = struct.unpack_from("<4I", data)
    if kind == 1:
        wanted, finite = 16 + 20 * first + 24 * second, data[16:16 + 12 * first]
    elif kind == 2:
        values, = struct.unpack_from("<I", data, 44)
        tools, = struct.unpack_from("<I", data, 64)
        wanted = 72 + 12 * first + 4 * values + 64 * tools
        finite = data[72:72 + 12 * first + 4 * values]
        for tool in range(tools):
            start = 72 + 12 * first + 4 * values + 64 * tool
            finite += data[start:start + 56]
    elif kind == 3:
        wanted, finite = 32 + 12 * second, data[32:]
    elif kind == 4:
        wanted = 16 + 20 * third + 68 * first + 12 * second
        finite = data[16:16 + 12 * third] + data[16 + 20 * third:16 + 20 * third + 32 * first]
    elif kind == 5:
        width, height = struct.unpack_from("<2I", data, 16)
        wanted, finite = 72 + (2 * width * height + 3) // 4 * 4, data[32:68]
    else:
        raise Wrong(f"a binary message of kind {kind}")
    if len(data) != wanted:
        raise Wrong(f"a binary message of kind {kind} with {len(data)} bytes instead of {wanted}")
    check_floats(finite, f"a binary message of kind {kind}")
    return kind


class Viewer:
    """One WebSocket connection. What has come is checked; what it says is kept for who asks."""

    def __init__(self, port, query="", timeout=5.0):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout)
        self.buffer = b""
        self.closed = None  # the code of a close frame
        self.leaves = False  # it has sent one itself, whose code comes back
        self.hello = self.status = None
        self.texts = []  # other messages, newest last
        self.waits_for_frame = False
        self.socket.sendall((
            f"GET /socket{query} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
            f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n"
            "Sec-WebSocket-Protocol: lariat.1\r\n\r\n").encode())
        while b"\r\n\r\n" not in self.buffer:
            self._more()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0]:
            raise Gone(head.split(b"\r\n")[0].decode("latin-1"))

    def _more(self):
        try:
            data = self.socket.recv(1 << 16)
        except (ConnectionError, socket.timeout) as error:
            raise Gone(str(error)) from error
        if not data:
            raise Gone("closed")
        self.buffer += data

    def send_frame(self, opcode, payload, final=True):
        """Frames of clients are masked; a mask of zeros is one."""
        self.leaves = self.leaves or opcode == 8
        head = bytes([(0x80 if final else 0) | opcode])
        if len(payload) < 126:
            head += bytes([0x80 | len(payload)])
        elif len(payload) < 1 << 16:
            head += bytes([0xFE]) + struct.pack(">H", len(payload))
        else:
            head += bytes([0xFF]) + struct.pack(">Q", len(payload))
        self.send_raw(head + bytes(4) + payload)

    def send_raw(self, data):
        try:
            self.socket.sendall(data)
        except (ConnectionError, socket.timeout) as error:
            raise Gone(str(error)) from error

    def say(self, **message):
        self.send_frame(1, json.dumps(message).encode())

    def _next_frame(self):
        """One frame of the buffer, or None."""
        data = self.buffer
        if len(data) < 2:
            return None
        length, at = data[1] & 0x7F, 2
        if length == 126:
            if len(data) < 4:
                return None
            length, at = struct.unpack_from(">H", data, 2)[0], 4
        elif length == 127:
            if len(data) < 10:
                return None
            length, at = struct.unpack_from(">Q", data, 2)[0], 10
        if len(data) < at + length:
            return None
        self.buffer = data[at + length:]
        return data[0] & 0x0F, data[at:at + length]

    def _take(self, opcode, payload):
        if opcode == 1:
            message = strict_json(payload.decode())
            kind = message["kind"]
            if kind == "hello":
                self.hello = message
            elif kind == "status":
                self.status = message
            else:
                self.texts = self.texts[-99:] + [message]
            if kind in ("no_frame",):
                self.waits_for_frame = False
        elif opcode == 2:
            if check_binary(payload) == 2:
                self.waits_for_frame = False
        elif opcode == 8:
            self.closed = struct.unpack(">H", payload[:2])[0] if len(payload) >= 2 else 1005
            if self.closed not in CLOSES and not self.leaves:
                raise Wrong(f"closed with {self.closed}")
            raise Gone(f"closed with {self.closed}")
        elif opcode == 9:
            self.send_frame(10, payload)

    def listen(self, seconds):
        """Takes what comes within that time. Raises Gone when the server has closed."""
        end = time.monotonic() + seconds
        while True:
            frame = self._next_frame()
            if frame:
                self._take(*frame)
                continue
            left = end - time.monotonic()
            if left <= 0:
                return
            self.socket.settimeout(left)
            try:
                data = self.socket.recv(1 << 16)
            except socket.timeout:
                return
            except ConnectionError as error:
                raise Gone(str(error)) from error
            finally:
                self.socket.settimeout(5.0)
            if not data:
                raise Gone("closed")
            self.buffer += data

    def wait_for(self, what, seconds=20.0):
        """Until what() is true; whether it became so."""
        end = time.monotonic() + seconds
        while not what() and time.monotonic() < end:
            self.listen(0.05)
        return bool(what())

    def close(self):
        self.socket.close()


def http(port, data, timeout=5.0):
    """What a server answers to these bytes, up to its end or the time."""
    answer = b""
    with socket.create_connection(("127.0.0.1", port), timeout) as link:
        link.settimeout(timeout)
        try:
            link.sendall(data)
            link.shutdown(socket.SHUT_WR)
            while True:
                piece = link.recv(1 << 16)
                if not piece:
                    break
                answer += piece
        except OSError:
            pass
    return answer


class Device:
    """A force-feedback device: docs/devices.md."""
    HEAD = struct.Struct("<4sHHIIQ")

    def __init__(self, port):
        self.port = port
        self.answers = 0
        self.number = 0
        self.renew()

    def renew(self):
        """From another port, with a new count: another sender."""
        if self.number:
            self.socket.close()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", self.port))
        self.socket.setblocking(False)

    def packet(self, place, opening=1.0, token=b""):
        self.number = (self.number + 1) % (1 << 32)
        return (self.HEAD.pack(b"LARD", 1, 1, self.number, 0, time.monotonic_ns() // 1000)
                + token.ljust(16, b"\0")[:16] + struct.pack("<8d", *place, 1, 0, 0, 0, opening))

    def send(self, data):
        try:
            self.socket.send(data)
        except OSError:
            pass  # nobody there at the moment: what a device cannot know

    def hear(self):
        """Takes all answers; every one is whole and finite."""
        while True:
            try:
                data = self.socket.recv(4096)
            except OSError:
                return
            if len(data) != 104 or data[:4] != b"LARD":
                raise Wrong(f"a device is answered with {len(data)} bytes")
            for value in struct.unpack_from("<9d", data, 32):
                if not abs(value) < 1e6:
                    raise Wrong(f"a device is told {value}")
            self.answers += 1

    def close(self):
        self.socket.close()


class Session:
    """A `lariat view` under test: its address, its ports, its end."""

    def __init__(self, arguments, folder, environment=None, name="view"):
        self.out_path = os.path.join(folder, name + ".json")
        self.err_path = os.path.join(folder, name + ".err")
        with open(self.out_path, "wb") as out, open(self.err_path, "wb") as err:
            self.process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=out,
                                            stderr=err, cwd=folder, env=environment)
        self.port = None

    def errors(self):
        with open(self.err_path, "rb") as err:
            return err.read().decode("utf-8", "replace")

    def begin(self, seconds=60.0):
        """Waits for the address; whether it came."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and self.process.poll() is None:
            found = re.search(r"^http://[^/]*:(\d+)/(?:#\S*)?\n", self.errors(), re.M)
            if found:
                self.port = int(found.group(1))
                return True
            time.sleep(0.02)
        return False

    def device_ports(self):
        return [int(port) for port in re.findall(r"expected at port (\d+)", self.errors())]

    def end(self, number, seconds=60.0):
        """Asks it to end with that signal. Returns its exit status, None when it does not end."""
        if self.process.poll() is None and number:
            self.process.send_signal(number)
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return None

    def report(self):
        with open(self.out_path, "rb") as out:
            text = out.read().decode()
        return strict_json(text) if text.strip() else None
