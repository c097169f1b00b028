# SPDX-License-Identifier: Apache-2.0
"""Builds a wheel of the package for pip (PEP 517): CMake builds and installs it into a folder, which is zipped.

Debian 12 has no scikit-build-core, so this is all of it. The wheel is linked to the libraries of the system that it was
built on (OpenVDB, oneTBB), and is for that system alone.
"""
import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def _version():
    with open(os.path.join(ROOT, "include", "vdb_offset", "api.h"), encoding="utf-8") as header:
        return re.search(r'define VDB_OFFSET_VERSION "([^"]+)"', header.read()).group(1)


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-" + re.sub(r"[.-]", "_", sysconfig.get_platform())


def _metadata():
    with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as readme:
        text = readme.read()
    return (f"Metadata-Version: 2.1\nName: vdb-offset\nVersion: {_version()}\nSummary: Offsets meshes and keeps their "
            "topology\nLicense: Apache-2.0\nRequires-Python: >=3.8\nRequires-Dist: numpy<2\n"
            f"Description-Content-Type: text/markdown\n\n{text}")


def _build(folder):
    """Builds and installs the package below a folder, as vdb_offset/."""
    build = os.environ.get("VDB_OFFSET_WHEEL_BUILD") or os.path.join(folder, "build")
    subprocess.run(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON",
                    "-DVDB_OFFSET_PYTHON=ON", "-DVDB_OFFSET_FILES=OFF", "-DVDB_OFFSET_TESTS=OFF",
                    f"-DPython3_EXECUTABLE={sys.executable}",
                    "-DVDB_OFFSET_PYTHON_DIR=."], check=True, stdout=sys.stderr)
    subprocess.run(["cmake", "--build", build, "--target", "vdb_offset_python"], check=True, stdout=sys.stderr)
    subprocess.run(["cmake", "--install", build, "--component", "python", "--strip", "--prefix",
                    os.path.join(folder, "package")], check=True, stdout=sys.stderr)
    return os.path.join(folder, "package")


def _info():
    """The files about the package, by their names."""
    info = f"vdb_offset-{_version()}.dist-info"
    with open(os.path.join(ROOT, "LICENSE"), "rb") as text:
        license_text = text.read()
    wheel = f"Wheel-Version: 1.0\nGenerator: vdb_offset\nRoot-Is-Purelib: false\nTag: {_tag()}\n"
    return info, {f"{info}/METADATA": _metadata().encode(), f"{info}/WHEEL": wheel.encode(), f"{info}/LICENSE": license_text}


def _digest(data):
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes the files about the package to a folder, without building anything."""
    info, files = _info()
    os.makedirs(os.path.join(metadata_directory, info))
    for path, data in files.items():
        with open(os.path.join(metadata_directory, path), "wb") as out:
            out.write(data)
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Builds the wheel in a folder, and returns its name."""
    name = f"vdb_offset-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as folder:
        package = _build(folder)
        files = {}
        for below, _, names in os.walk(package):
            for each in sorted(names):
                path = os.path.join(below, each)
                with open(path, "rb") as content:
                    files[os.path.relpath(path, package)] = content.read()
    info, about = _info()
    files.update(about)
    record = "".join(f"{path},{_digest(data)},{len(data)}\n" for path, data in files.items()) + f"{info}/RECORD,,\n"
    files[f"{info}/RECORD"] = record.encode()
    with zipfile.ZipFile(os.path.join(wheel_directory, name), "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            wheel.writestr(path, data)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("vdb_offset: a wheel is built from a clone of the project, not from a source package")
