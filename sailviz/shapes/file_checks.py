"""What a file of facets says of itself before anything of it is read: how large it is, how much it unpacks to, how many
facets it claims, what it wants to read besides. Each function returns nothing and raises ShapeError in a sentence."""

from __future__ import annotations

import io
import json
import re
import struct
import zipfile
from pathlib import Path, PureWindowsPath
from typing import Any

from sailviz.errors import SailvizError
from sailviz.words import shown

MOST_FACETS = 200_000
LARGEST_FILE = 200_000_000  # bytes, packed or not
MOST_MEMBERS = 1000  # of a zip file
MOST_NUMBERS = 20_000_000  # that a GLB file may claim


class ShapeError(SailvizError):
    """A shape that cannot be had, in a sentence."""


def facets(count: int, name: str) -> None:
    """Not more facets than a table is made for."""
    if count > MOST_FACETS:
        raise ShapeError(f"{shown(name)} has {count} facets, more than {MOST_FACETS}: decimate it")


def size(count: int, name: str) -> None:
    """Not larger than a file of so many facets."""
    if count > LARGEST_FILE:
        raise ShapeError(f"{shown(name)} is {count / 1e6:.0f} MB, more than {LARGEST_FILE / 1e6:.0f} MB: decimate it")


def reference(word: str, name: str) -> None:
    """What a file names to be read with it lies beside it or below, and nowhere else."""
    windows = PureWindowsPath(word)
    outside = word.startswith(("/", "\\", "~")) or windows.drive or ".." in windows.parts or "://" in word
    if outside:
        raise ShapeError(f"{shown(name)} names {shown(word)}, which lies outside its folder")


def stl(content: bytes, name: str) -> None:
    """STL, binary or as text."""
    if len(content) >= 84 and not _is_text_stl(content):
        claimed = struct.unpack("<I", content[80:84])[0]
        facets(claimed, name)
        if len(content) != 84 + 50 * claimed:
            raise ShapeError(f"{shown(name)} says {claimed} facets, and its length is not that of so many")
        return
    facets(content.count(b"facet normal"), name)


def _is_text_stl(content: bytes) -> bool:
    claimed = struct.unpack("<I", content[80:84])[0]
    return content.lstrip()[:5].lower() == b"solid" and len(content) != 84 + 50 * claimed


def obj(content: bytes, name: str) -> None:
    """OBJ, and the libraries of materials that it names."""
    facets(len(re.findall(rb"(?m)^[ \t]*f[ \t]", content)), name)
    for line in re.findall(rb"(?m)^[ \t]*mtllib[ \t]+(.+?)[ \t\r]*$", content):
        reference(line.decode("utf-8", "replace"), name)


def materials(path: Path, name: str, content: bytes) -> None:
    """The textures that an OBJ file's libraries of materials name; they are not read."""
    for line in re.findall(rb"(?m)^[ \t]*mtllib[ \t]+(.+?)[ \t\r]*$", content):
        library = path.parent / line.decode("utf-8", "replace")
        if library.is_symlink() or not library.is_file() or library.stat().st_size > LARGEST_FILE:
            continue
        for texture in re.findall(
            rb"(?m)^[ \t]*(?:map_\w+|bump|disp|decal|refl)[ \t]+(.+?)[ \t\r]*$", library.read_bytes()
        ):
            reference(texture.decode("utf-8", "replace").split()[-1], library.name)


def ply(content: bytes, name: str) -> None:
    """PLY: what its head says."""
    head, end, _ = content.partition(b"end_header")
    if not content.startswith(b"ply") or not end:
        raise ShapeError(f"{shown(name)} is no PLY file: its head does not end")
    for what, count in re.findall(rb"(?m)^element[ \t]+(\w+)[ \t]+(\d{1,18})[ \t\r]*$", head):
        if what == b"face":
            facets(int(count), name)
        elif int(count) > 3 * MOST_FACETS:
            raise ShapeError(f"{shown(name)} says {int(count)} {what.decode()} elements: more than a shape needs")
    for line in re.findall(rb"(?m)^comment[ \t]+TextureFile[ \t]+(.+?)[ \t\r]*$", head):
        reference(line.decode("utf-8", "replace"), name)


def glb(content: bytes, name: str) -> None:
    """Binary glTF: its lengths, its claims, and that it needs no other file outside its folder."""
    if len(content) < 20 or content[:4] != b"glTF":
        raise ShapeError(f"{shown(name)} is no GLB file")
    version, total, length, kind = struct.unpack("<IIII", content[4:20])
    if version != 2 or kind != 0x4E4F534A or total > len(content) or 20 + length > len(content):
        raise ShapeError(f"{shown(name)} is no whole GLB file of version 2")
    try:
        described = json.loads(content[20 : 20 + length])
        numbers = sum(int(each["count"]) for each in described.get("accessors", []))
        named = [each for key in ("buffers", "images") for each in described.get(key, [])]
        uris = [str(each["uri"]) for each in named if "uri" in each]
        tree(described, name)
    except (ValueError, TypeError, KeyError, AttributeError, IndexError, RecursionError):
        raise ShapeError(f"{shown(name)} is damaged: what it says of itself cannot be read") from None
    if numbers > MOST_NUMBERS:
        raise ShapeError(f"{shown(name)} claims {numbers} numbers: more than a shape needs")
    for uri in uris:
        if not uri.startswith("data:"):
            reference(uri, name)


def tree(described: dict[str, Any], name: str) -> None:
    """The nodes of a glTF file are a tree, as the standard wants it: a node in two places makes copies of copies."""
    children = [int(child) for node in described.get("nodes", []) for child in node.get("children", [])]
    if len(children) != len(set(children)):
        raise ShapeError(f"{shown(name)} has a node in two places: its nodes are no tree")
    used = sum(1 for node in described.get("nodes", []) if "mesh" in node)
    counts = []
    for mesh in described.get("meshes", []):
        for primitive in mesh["primitives"]:
            at = primitive.get("indices", primitive["attributes"]["POSITION"])
            counts.append(int(described["accessors"][at]["count"]) // 3)
    facets(max(sum(counts), max(counts, default=0) * used if used < 10_000 else MOST_FACETS + 1), name)


def threemf(content: bytes, name: str) -> str:
    """3MF: a zip file, looked at before it is unpacked. Returns its unit, "millimeter" where it says none."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
        members = archive.infolist()
        unpacked = sum(member.file_size for member in members)
        if len(members) > MOST_MEMBERS or unpacked > LARGEST_FILE:
            raise ShapeError(
                f"{shown(name)} unpacks to {unpacked / 1e6:.0f} MB in {len(members)} files: more than a shape needs"
            )
        for member in members:
            reference(member.filename, name)
        models = [member for member in members if member.filename.lower().endswith(".model")]
        text = b"".join(archive.read(member) for member in models)
    except (zipfile.BadZipFile, OSError, NotImplementedError, RuntimeError, EOFError, ValueError) as error:
        raise ShapeError(f"{shown(name)} is no 3MF file: {error}") from None
    except Exception as error:  # zlib's own
        raise ShapeError(f"{shown(name)} is damaged: {error}") from None
    if not models:
        raise ShapeError(f"{shown(name)} is no 3MF file: it holds no model")
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise ShapeError(f"{shown(name)} declares entities, which a 3MF file has no use for")
    facets(len(re.findall(rb"<(?:\w+:)?triangle[\s/]", text)), name)
    found = re.search(rb"<(?:\w+:)?model\b[^>]*?\bunit\s*=\s*[\"'](\w+)[\"']", text)
    return found.group(1).decode() if found else "millimeter"
