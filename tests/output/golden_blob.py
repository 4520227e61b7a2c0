#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the golden blobs of format 2.0, byte by byte from docs/blob.md, without mdhcal's writer.

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
    blob = bytearray(8160)
    blob[0:4] = b"\xA0\x6B\xBC\xCC"
    blob[4:8] = b"\x02\x00\x00\x00"
    blob[8:12] = b"\xE0\x1F\x00\x00"
    blob[12:16] = b"\xBF\x6A\xFD\x5D"
    put(blob, 16, "8I", flags, joints, targets, family, counter, arithmetic, doubles, floats)
    return blob


def finish(blob):
    put(blob, 8156, "I", zlib.crc32(bytes(blob[:8156])))
    return bytes(blob)


def every_field():
    blob = start(0x1F, 8, 8, 2, 77, 0x12345678, 4, 4)
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
        put(blob, base + 176, "d", 1.5 + i / 4)
        put(blob, 3520 + 352 * i + 8, "2d", -1.5 - i / 16, 1.75 + i / 32)
        if i not in (2, 5):
            orders = 40 - i
            put(blob, 3520 + 352 * i, "I", orders)
            put(blob, 3520 + 352 * i + 32, "%df" % orders, *[1e-5 * (i + 1 + k / 64) for k in range(orders)])
            put(blob, 3520 + 352 * i + 192, "%df" % orders, *[-1e-5 * (i + 1.5 + k / 64) for k in range(orders)])
            put(blob, 6400 + 8 * i, "d", 1e-9 * (i + 1.25))
            put(blob, 6464 + 64 * i + 8 * i, "%dd" % (8 - i), *[1e-9 * (i + 2) * (-1) ** j / (j + 1) for j in range(i, 8)])
    put(blob, 1696, "7d", 0.5, -0.5, 0.5, 0.5, 0.011, -0.022, 0.033)
    put(blob, 1760, "7d", 0.8, 0.0, -0.6, 0.0, 1.25, -2.5, 0.75)
    for i in range(8):
        put_text(blob, 1824 + 40 * i, 16, "target-%d" % i if i else "")
        put(blob, 1824 + 40 * i + 16, "3d", 0.1 + i, -0.2 - i, 0.3 * i)
    put(blob, 2144, "2d2f", 1e-10, 2e-10, 1e-5, 2e-5)
    put_text(blob, 2176, 32, "golden_blob.py for format 2.0")
    put_text(blob, 2208, 16, "2026-11-21")
    put_text(blob, 2224, 16, "rpim")
    blob[2240:2272] = bytes(range(0x80, 0xA0))
    put_text(blob, 2272, 32, "quasi-optimality")
    put(blob, 2304, "dII", 0.015625, 1234, 567)
    put(blob, 2336, "4d", 0.00265, 0.0051, 0.000032, 0.000148)
    put(blob, 6336, "7d", 0.6, 0.0, -0.8, 2.5, 0.01, -0.02, 0.125)
    put(blob, 6976, "8d", -1.0, -2.0, 0.25, 1.5, 2.5, 3.5, 0.125, 2.75)
    for v in range(4):
        q = [(v + 1) * 0.1 + 0.01 * i for i in range(8)]
        angle = 0.3 + v
        pose = [math.cos(angle), 0.0, math.sin(angle), 0.0, 1.0 + v, -2.0 - v, 3.0 * v]
        if pose[0] < 0:
            pose[:4] = [-c for c in pose[:4]]
        joints = [-x for x in q]
        put(blob, 2368 + 192 * v, "23di", *q, *pose, *joints, v)
        put(blob, 3136 + 96 * v, "23fi", *[x / 2 for x in q], *pose, *[x / 4 for x in joints], 5 - v)
    put(blob, 8032, "I", 1)
    blob[8040:8048] = bytes(range(0xC0, 0xC8))
    blob[8064:8128] = bytes(range(1, 65))
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
    put_text(blob, 2176, 32, "golden_blob.py for format 2.0")
    # Orders 1 and 18 on joint 2, 28 on joint 4, seen all round; every link's weight on joints 2 and 3.
    cosines = {(1, 1): 2.0 ** -13, (1, 18): 2.0 ** -14, (3, 28): -2.0 ** -13}
    sines = {(1, 1): -2.0 ** -12, (3, 28): 2.0 ** -14}
    for i in range(6):
        put(blob, 3520 + 352 * i + 8, "2d", -3.15, 3.15)
    for (i, k), value in cosines.items():
        put(blob, 3520 + 352 * i + 32 + 4 * (k - 1), "f", value)
    for (i, k), value in sines.items():
        put(blob, 3520 + 352 * i + 192 + 4 * (k - 1), "f", value)
    put(blob, 3520 + 352, "I", 18)
    put(blob, 3520 + 352 * 3, "I", 28)
    down = [0.0, 0.0, -1.0]
    weights = {(i, j): 1e-4 * (i + 1) * (7 - j) for i in (1, 2) for j in range(i, 6)}
    put(blob, 6336, "3d", *down)
    for (i, j), value in weights.items():
        put(blob, 6464 + 64 * i + 8 * j, "d", value)

    def chain(angles):
        """The frames after each link but for beta, and the flange's."""
        t = shift(0, 0, 0)
        frames = []
        for i in range(6):
            alpha, a, theta, d, beta = corrected[i]
            for factor in (turn(0, alpha), shift(a, 0, 0), turn(2, angles[i] + theta), shift(0, 0, d)):
                t = product(t, factor)
            frames.append(t)
            t = product(t, turn(1, beta))
        return frames + [t]

    def forward(q):
        angles = []
        for i in range(6):
            f = sum(c * math.cos(k * q[i]) for (j, k), c in cosines.items() if j == i)
            f += sum(s * math.sin(k * q[i]) for (j, k), s in sines.items() if j == i)
            angles.append(signs[i] * q[i] + (0.25 * q[1] if i == 2 else 0.0) + f)
        frames = chain(angles)
        sag = [0.0] * 6
        for (i, j), k in weights.items():
            lever = [frames[j + 1][r][3] - frames[i][r][3] for r in range(3)]
            moment = [lever[(r + 1) % 3] * down[(r + 2) % 3] - lever[(r + 2) % 3] * down[(r + 1) % 3] for r in range(3)]
            sag[i] += k * math.fsum(frames[i][r][2] * moment[r] for r in range(3))
        t = chain([angles[i] + sag[i] for i in range(6)])[6]
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
