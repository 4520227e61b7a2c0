#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Reads a parameter blob of format 2 as docs/blob.md describes it and prints every field as JSON.

read_blob.py FILE
"""
import json
import struct
import sys
import zlib


class Refused(Exception):
    pass


def read(blob):
    def get(offset, form):
        values = struct.unpack_from("<" + form, blob, offset)
        return values[0] if len(values) == 1 else list(values)

    def text(offset, size):
        head, zero, tail = blob[offset:offset + size].partition(b"\0")
        if not zero or tail.strip(b"\0"):
            raise Refused("text at %d" % offset)
        return head.decode("utf-8")

    def reserved(offset, size):
        if any(blob[offset:offset + size]):
            raise Refused("reserved bytes at %d" % offset)

    def pose(offset):
        reserved(offset + 56, 8)
        return {"quaternion": get(offset, "4d"), "position": get(offset + 32, "3d")}

    def joint(offset):
        reserved(offset + 12, 4)
        reserved(offset + 184, 8)
        return {"kind": get(offset, "i"), "sign": get(offset + 4, "i"), "flags": get(offset + 8, "I"),
                "min": get(offset + 16, "d"), "max": get(offset + 24, "d"), "nominal": get(offset + 32, "5d"),
                "corrected": get(offset + 72, "5d"), "coupling": get(offset + 112, "8d"), "max_velocity": get(offset + 176, "d")}

    def function(offset):
        reserved(offset + 4, 4)
        reserved(offset + 24, 8)
        return {"order_count": get(offset, "I"), "seen_min": get(offset + 8, "d"), "seen_max": get(offset + 16, "d"),
                "cosine": get(offset + 32, "40f"), "sine": get(offset + 192, "40f")}

    def vector(offset, real, size):
        return {"q": get(offset, "8" + real), "pose": get(offset + 8 * size, "7" + real),
                "inverse_q": get(offset + 15 * size, "8" + real), "inverse_status": get(offset + 23 * size, "i")}

    if len(blob) != 8160:
        raise Refused("size")
    if get(0, "I") != 0xCCBC6BA0 or get(4, "H") != 2 or get(8, "I") != 8160 or get(12, "I") != 0x5DFD6ABF:
        raise Refused("magic, version, size or layout id")
    if get(8156, "I") != zlib.crc32(blob[:8156]):
        raise Refused("CRC-32")
    reserved(7040, 992)
    reserved(6392, 8)
    if get(6, "H") == 0:
        for offset, size in ((48, 16), (2168, 8), (2320, 16), (8036, 4), (8048, 16), (8128, 28),
                             (2556, 4), (2748, 4), (2940, 4), (3132, 4)):
            reserved(offset, size)
    return {
        "major": get(4, "H"), "minor": get(6, "H"), "flags": get(16, "I"), "joint_count": get(20, "I"),
        "target_count": get(24, "I"), "family": get(28, "I"), "security_counter": get(32, "I"),
        "arithmetic_id": get(36, "I"), "double_vector_count": get(40, "I"), "float_vector_count": get(44, "I"),
        "name": text(64, 64), "serial": text(128, 32),
        "joints": [joint(160 + 192 * i) for i in range(8)],
        "last_T_flange": pose(1696), "tracker_T_base": pose(1760),
        "targets": [{"name": text(1824 + 40 * i, 16), "point": get(1840 + 40 * i, "3d")} for i in range(8)],
        "tolerances": get(2144, "2d2f"), "tool_version": text(2176, 32), "date": text(2208, 16),
        "method": text(2224, 16), "measurements_sha256": blob[2240:2272].hex(), "lambda_rule": text(2272, 32),
        "lambda": get(2304, "d"), "pose_count": get(2312, "I"), "held_out_count": get(2316, "I"),
        "held_out": get(2336, "4d"),
        "double_vectors": [vector(2368 + 192 * i, "d", 8) for i in range(4)],
        "float_vectors": [vector(3136 + 96 * i, "f", 4) for i in range(4)],
        "functions": [function(3520 + 352 * i) for i in range(8)],
        "gravity": get(6336, "3d"), "payload": get(6360, "d"), "payload_com": get(6368, "3d"),
        "payload_compliance": get(6400, "8d"), "compliance": get(6464, "64d"),
        "region_min": get(6976, "3d"), "region_max": get(7000, "3d"), "lean": get(7024, "2d"),
        "algorithm": get(8032, "I"), "key_id": blob[8040:8048].hex(), "signature": blob[8064:8128].hex(),
    }


if __name__ == "__main__":
    with open(sys.argv[1], "rb") as source:
        try:
            json.dump(read(source.read()), sys.stdout)
        except Refused as why:
            sys.exit("refused: %s" % why)
