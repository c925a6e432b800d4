"""Bytes of a request over stock HTTPS on the link, packet headers included, by body size.

Run in a network of its own (`unshare --net`): prints JSON, for a connection of its own and
for one that stays open, [bytes of body, IP bytes both ways] of each request. The server
is Python's HTTP server with OpenSSL as it comes, TLS 1.3, a chain of two certificates on
P-256 under a root, as public authorities have it, and the usual response headers; the client
sends the usual ones of an HTTP client and a bearer token of 300 bytes.
"""

import http.client
import http.server
import json
import os
import ssl
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

SERVER, PORT = "10.77.0.1", 8443
LINK = Path(__file__).parents[4] / "tests/satellite/link.py"
SIZES = [100, 200, 400, 800, 1_600, 3_200, 6_400, 12_800]
TIMES = 3
# Until the last packet of a connection is across.
SETTLE_S = 1.2
TOKEN = "t" * 300


def certificates(folder):
    """A root, an authority under it and the server's certificate, made by openssl."""
    def openssl(*words):
        subprocess.run(["openssl", *words], check=True, cwd=folder, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    key = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"]
    openssl("req", "-x509", *key, "-keyout", "root.key", "-out", "root.pem", "-days", "9",
            "-subj", "/C=US/O=Example Trust Services/CN=Example Root R1")
    signed = [("ca", "/C=US/O=Example Trust Services/CN=E7", "root",
               "basicConstraints=critical,CA:TRUE,pathlen:0\n"),
              ("leaf", "/CN=telemetry.example.com", "ca",
               f"subjectAltName=DNS:telemetry.example.com,IP:{SERVER}\n"
               "extendedKeyUsage=serverAuth,clientAuth\n"
               "authorityInfoAccess=OCSP;URI:http://e7.o.example.org,"
               "caIssuers;URI:http://e7.i.example.org/\n"
               "crlDistributionPoints=URI:http://e7.c.example.org/42.crl\n")]
    for name, subject, by, extensions in signed:
        (folder / f"{name}.ext").write_text(extensions)
        openssl("req", "-new", *key, "-keyout", f"{name}.key", "-out", f"{name}.csr",
                "-subj", subject)
        openssl("x509", "-req", "-in", f"{name}.csr", "-CA", f"{by}.pem", "-CAkey", f"{by}.key",
                "-CAcreateserial", "-days", "9", "-out", f"{name}.pem",
                "-extfile", f"{name}.ext")
    chain = (folder / "leaf.pem").read_text() + (folder / "ca.pem").read_text()
    (folder / "chain.pem").write_text(chain)


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    wbufsize = -1

    def do_POST(self):
        self.rfile.read(int(self.headers["content-length"]))
        body = b'{"accepted":true}'
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


def serve(folder):
    tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    tls.load_cert_chain(folder / "chain.pem", folder / "leaf.key")
    server = http.server.ThreadingHTTPServer((SERVER, PORT), Handler)
    server.daemon_threads = True
    server.socket = tls.wrap_socket(server.socket, server_side=True, do_handshake_on_connect=False)
    threading.Thread(target=server.serve_forever, daemon=True).start()


def run_client(folder):
    """The client: each line has the size of a body and whether to keep the connection."""
    tls = ssl.create_default_context(cafile=folder / "root.pem")
    line = None
    for order in sys.stdin:
        size, keep = json.loads(order)
        line = line or http.client.HTTPSConnection(SERVER, PORT, context=tls)
        line.request("POST", "/api/v2/write?org=fleet&bucket=compass", os.urandom(size), {
            "User-Agent": "telemetry-agent/1.4.2", "Accept": "*/*",
            "Content-Type": "application/octet-stream", "Content-Encoding": "gzip",
            "Authorization": f"Bearer {TOKEN}"})
        response = line.getresponse()
        response.read()
        if response.status != 200:
            raise SystemExit(f"the server responded {response.status}")
        if not keep:
            line.close()
            line = None
        print("done", flush=True)


def main():
    folder = Path(tempfile.mkdtemp())
    certificates(folder)
    link = subprocess.Popen([sys.executable, LINK], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            text=True)
    ship = str(json.loads(link.stdout.readline())["ship"])

    def order(**what):
        link.stdin.write(json.dumps(what) + "\n")
        link.stdin.flush()

    def bytes_on_link():
        time.sleep(SETTLE_S)
        order(tally=True)
        return sum(way["bytes"] for way in json.loads(link.stdout.readline()).values())

    order(round_trip_ms=300)
    serve(folder)
    client = subprocess.Popen(
        ["nsenter", "--net", "--target", ship, "--", sys.executable, __file__, "client", folder],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def request(size, keep):
        before = bytes_on_link()
        client.stdin.write(json.dumps([size, keep]) + "\n")
        client.stdin.flush()
        if client.stdout.readline() != "done\n":
            raise SystemExit("the ship's client ended")
        return bytes_on_link() - before

    def mean(size, keep):
        return sum(request(size, keep) for _ in range(TIMES)) / TIMES

    own = [[size, mean(size, False)] for size in SIZES]
    request(100, True)
    opened = [[size, mean(size, True)] for size in SIZES]
    print(json.dumps({"own": own, "open": opened}))
    client.stdin.close()
    client.wait()
    link.stdin.close()
    link.wait()


if __name__ == "__main__":
    if sys.argv[1:2] == ["client"]:
        run_client(Path(sys.argv[2]))
    else:
        main()
