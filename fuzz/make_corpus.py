#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the fuzz targets' seed corpora anew: corpus/parser from the transcripts' bytes, and
corpus/decode from packets worth a look. What they look like stands at the head of each target."""
import pathlib

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


parser_corpus()
decode_corpus()
