#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the fuzz targets' seed corpora anew: corpus/parser from the transcripts' bytes, and
corpus/decode from packets worth a look; with the program g4-dump as the argument, also
corpus/layouts, from simulated lidars. What they look like stands at the head of each target."""
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
TRANSCRIPTS = HERE.parent / "tests" / "transcripts"


def fresh(name):
    directory = HERE / "corpus" / name
    directory.mkdir(parents=True, exist_ok=True)
    for old in directory.iterdir():
        old.unlink()
    return directory


def bytes_of(transcript):
    hexadecimal = ""
    for line in transcript.read_text("ascii").splitlines():
        if line.startswith("<"):
            hexadecimal += line[1:].split("#")[0]
    return bytes.fromhex(hexadecimal)


def parser_corpus():
    out = fresh("parser")
    cuts = [b"\x00", b"\x01\x01", b"\x03\x05\x00\x09", b"\x02\x40\x03"]  # count, then the sizes
    for i, transcript in enumerate(sorted(TRANSCRIPTS.glob("*.txt"))):
        seal = bytes([i % 2])
        (out / transcript.stem).write_bytes(seal + cuts[i % len(cuts)] + bytes_of(transcript))


def packet(ct, first, last, samples):
    words = [first, last, *samples]
    return bytes([ct, len(samples) - 1]) + b"".join(w.to_bytes(2, "little") for w in words)


def decode_corpus():
    out = fresh("decode")
    turn = 360 * 64
    inputs = {
        "zero_packet": packet(1, 22313, 22313, [0]),
        "forty_samples": packet(0, 14322, 15582, range(4000, 32000, 700)),
        "eighty_samples": packet(0, 1000, 3000, range(1, 16001, 200)),
        "raw_0_to_3": packet(0, 6400, 6600, [0, 1, 2, 3]),
        "too_near": packet(0, 6400, 6600, [399, 400, 401, 620, 621, 622]),
        "far": packet(0, 6400, 6600, [65535, 65534, 32768]),
        "wrap": packet(0, turn - 20, 20, range(1000, 3000, 100)),
        "wrap_limit": packet(0, 270 * 64 + 1, 90 * 64 - 1, [4000] * 9),
        "suspect": packet(0, 270 * 64, 90 * 64 - 1, [4000] * 9) + packet(1, 100, 99, [5]),
        "near_0_both_sides": packet(0, 0, 511, [600 + 3 * i for i in range(80)])
        + packet(0, turn - 511, turn - 1, [1 + i for i in range(80)]),
        "one_angle": packet(0, 0, 0, [622] * 40),
        "revolutions": b"".join(packet(1, a, a, [800]) + packet(0x86, a, a + 9, [1, 0]) for a in (0, 9, 99)),
    }
    for name, data in inputs.items():
        (out / name).write_bytes(data)


def layouts_corpus(g4_dump):
    out = fresh("layouts")
    models = ["g4", "x4", "g6", "tg15", "g2", "s4b", "scl", "t-mini", "t-mini-plus-sh"]
    for number, model in enumerate(models):
        command = [g4_dump, "sim", "--model", model, "--seconds", "0.4", "--dropout", "0.1"]
        stream = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout
        zero = max(at for at in range(len(stream) - 4) if stream[at:at + 2] == b"\xaa\x55" and stream[at + 2] & 1)
        whole = stream[zero - 200:zero + 200]
        (out / model).write_bytes(bytes([number, 14]) + whole)
        (out / (model + "_sealed")).write_bytes(bytes([number, 9]) + bytes(b ^ (i % 61 == 50) for i, b in enumerate(whole)))


parser_corpus()
decode_corpus()
if len(sys.argv) > 1:
    layouts_corpus(sys.argv[1])
