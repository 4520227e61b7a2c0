#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the golden blobs of format 1.0, byte by byte from docs/blob.md, without mdhcal's writer.

golden_blob.py every-field|six-joints FILE

every-field: eight joints, eight targets, all vectors, every value different from every other; not a sensible arm.
six-joints: an arm whose self-test vectors are computed here by plain 4x4 products, under an arithmetic id of nobody's.
"""
import math
import struct
import sys
import zlib


def put(blob, offset, form, *values):
    struct.pack_into("<" + form, blob, offset, *values)


def put_text(blob, offset, size, text):
    data = text.encode("utf-8")
    assert len(data) < size
    blob[offset:offset + len(data)] = data


def start(flags, joints, targets, family, counter, arithmetic, doubles, floats):
    blob = bytearray(4096)
    blob[0:4] = b"\xA0\x6B\xBC\xCC"
    blob[4:8] = b"\x01\x00\x00\x00"
    blob[8:12] = b"\x00\x10\x00\x00"
    blob[12:16] = b"\xE6\x1C\x46\x0D"
    put(blob, 16, "8I", flags, joints, targets, family, counter, arithmetic, doubles, floats)
    return blob


def finish(blob):
    put(blob, 4092, "I", zlib.crc32(bytes(blob[:4092])))
    return bytes(blob)


def every_field():
    blob = start(0x0F, 8, 8, 2, 77, 0x12345678, 4, 4)
    put_text(blob, 64, 64, "Prüfling 8")
    put_text(blob, 128, 32, "SN/2026-0815")
    for i in range(8):
        base = 160 + 192 * i
        put(blob, base, "iiI", 1 if i in (2, 5) else 0, -1 if i in (1, 4) else 1, (3, 1, 2, 0)[i % 4])
        if i % 4 in (0, 1):
            put(blob, base + 16, "d", -2.5 - i)
        if i % 4 in (0, 2):
            put(blob, base + 24, "d", 2.5 + i / 8)
        nominal = [0.1 * i - 0.35, 0.2 + 0.01 * i, 0.3 - 0.02 * i, -0.4 + 0.03 * i, 0.001 * i]
        put(blob, base + 32, "5d", *nominal)
        put(blob, base + 72, "5d", *[v + 1e-4 * (i + 1) * (k - 2.5) for k, v in enumerate(nominal)])
        put(blob, base + 112, "8d", *[0.0 if j == i else (i - 3.5) / (j + 1.25) for j in range(8)])
    put(blob, 1696, "7d", 0.5, -0.5, 0.5, 0.5, 0.011, -0.022, 0.033)
    put(blob, 1760, "7d", 0.8, 0.0, -0.6, 0.0, 1.25, -2.5, 0.75)
    for i in range(8):
        put_text(blob, 1824 + 40 * i, 16, "target-%d" % i if i else "")
        put(blob, 1824 + 40 * i + 16, "3d", 0.1 + i, -0.2 - i, 0.3 * i)
    put(blob, 2144, "2d2f", 1e-10, 2e-10, 1e-5, 2e-5)
    put_text(blob, 2176, 32, "golden_blob.py for format 1.0")
    put_text(blob, 2208, 16, "2026-11-21")
    put_text(blob, 2224, 16, "rpim")
    blob[2240:2272] = bytes(range(0x80, 0xA0))
    put_text(blob, 2272, 32, "quasi-optimality")
    put(blob, 2304, "dII", 0.015625, 1234, 567)
    put(blob, 2336, "4d", 0.00265, 0.0051, 0.000032, 0.000148)
    for v in range(4):
        q = [(v + 1) * 0.1 + 0.01 * i for i in range(8)]
        angle = 0.3 + v
        pose = [math.cos(angle), 0.0, math.sin(angle), 0.0, 1.0 + v, -2.0 - v, 3.0 * v]
        if pose[0] < 0:
            pose[:4] = [-c for c in pose[:4]]
        joints = [-x for x in q]
        put(blob, 2368 + 192 * v, "23di", *q, *pose, *joints, v)
        put(blob, 3136 + 96 * v, "23fi", *[x / 2 for x in q], *pose, *[x / 4 for x in joints], 5 - v)
    put(blob, 3968, "I", 1)
    blob[3976:3984] = bytes(range(0xC0, 0xC8))
    blob[4000:4064] = bytes(range(1, 65))
    return finish(blob)


def product(a, b):
    return [[math.fsum(a[r][k] * b[k][c] for k in range(4)) for c in range(4)] for r in range(4)]


def turn(axis, angle):
    m = [[float(r == c) for c in range(4)] for r in range(4)]
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    m[i][i] = m[j][j] = math.cos(angle)
    m[i][j], m[j][i] = -math.sin(angle), math.sin(angle)
    return m


def shift(x, y, z):
    m = [[float(r == c) for c in range(4)] for r in range(4)]
    m[0][3], m[1][3], m[2][3] = x, y, z
    return m


def quaternion(m):
    """w, x, y, z with w >= 0, for rotations less than half a turn away from none."""
    w = math.sqrt(max(0.0, 1.0 + m[0][0] + m[1][1] + m[2][2])) / 2
    assert w > 0.1
    return [w, (m[2][1] - m[1][2]) / (4 * w), (m[0][2] - m[2][0]) / (4 * w), (m[1][0] - m[0][1]) / (4 * w)]


def six_joints():
    blob = start(0x00, 6, 0, 1, 0, 0, 2, 2)
    put_text(blob, 64, 64, "golden six")
    half = math.pi / 2
    links = [[0.0, 0.0, 0.0, 0.4, 0.0], [-half, 0.025, -half, 0.0, 0.0], [0.0, 0.455, 0.0, 0.0, 0.0],
             [-half, 0.035, 0.0, 0.42, 0.0], [half, 0.0, 0.0, 0.0, 0.0], [-half, 0.0, 0.0, 0.08, 0.0]]
    corrected = [[v + 1e-4 * (k + 1 + i) * (-1) ** (k + i) for k, v in enumerate(link)] for i, link in enumerate(links)]
    signs = [1, 1, 1, -1, 1, -1]
    for i in range(6):
        put(blob, 160 + 192 * i, "iiI", 0, signs[i], 0)
        put(blob, 160 + 192 * i + 32, "5d", *links[i])
        put(blob, 160 + 192 * i + 72, "5d", *corrected[i])
    put(blob, 160 + 192 * 2 + 112, "8d", 0, 0.25, 0, 0, 0, 0, 0, 0)
    put(blob, 1696, "7d", 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    put(blob, 2144, "2d2f", 1e-10, 1e-10, 5e-6, 5e-6)
    put_text(blob, 2176, 32, "golden_blob.py for format 1.0")

    def forward(q):
        t = shift(0, 0, 0)
        for i in range(6):
            alpha, a, theta, d, beta = corrected[i]
            angle = signs[i] * q[i] + (0.25 * q[1] if i == 2 else 0.0) + theta
            for factor in (turn(0, alpha), shift(a, 0, 0), turn(2, angle), shift(0, 0, d), turn(1, beta)):
                t = product(t, factor)
        return quaternion(t) + [t[0][3], t[1][3], t[2][3]]

    # Readings that binary32 holds, away from the elbow's and the wrist's singularities.
    for v, q in enumerate(([0.25, -0.5, 0.125, 0.375, -1.25, -0.25], [-0.5, 0.25, -0.25, -0.625, -1.0, 0.5])):
        row = q + [0.0, 0.0] + forward(q) + q + [0.0, 0.0]
        put(blob, 2368 + 192 * v, "23di", *row, 0)
        put(blob, 3136 + 96 * v, "23fi", *row, 0)
    return finish(blob)


if __name__ == "__main__":
    make = {"every-field": every_field, "six-joints": six_joints}[sys.argv[1]]
    with open(sys.argv[2], "wb") as out:
        out.write(make())
