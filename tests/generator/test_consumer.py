"""ocm_generate_topics() in a project of its own: configure, build, change the spec, break it, mend it.

Usage: test_consumer.py --source OCM --generator NAME [--ocm-generate PROGRAM] [--arm]
With --arm the project is built for a Cortex-M0, and the generator, unless one is given, for this machine.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile


def run(*command, fails=False):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if (done.returncode != 0) != fails:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}\nended with {done.returncode}")
    return done.stdout


def expect(what, condition):
    if not condition:
        sys.exit(f"not so: {what}")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--source", type=pathlib.Path, required=True)
    arguments.add_argument("--generator", required=True)
    arguments.add_argument("--ocm-generate")
    arguments.add_argument("--arm", action="store_true")
    options = arguments.parse_args()

    if shutil.which("ccache"):
        os.environ.setdefault("CMAKE_CXX_COMPILER_LAUNCHER", "ccache")
    with tempfile.TemporaryDirectory() as scratch:
        project = pathlib.Path(scratch) / "project"
        build = pathlib.Path(scratch) / "build"
        shutil.copytree(options.source / "tests" / "rules" / "consumers" / "generate", project)
        spec = project / "theirs.json"
        shutil.copy(options.source / "examples" / "other-robot" / "topics.json", spec)

        configure = ["cmake", "-G", options.generator, "-S", project, "-B", build, f"-DOCM_SOURCE={options.source}"]
        if options.arm:
            configure.append(f"-DCMAKE_TOOLCHAIN_FILE={project / 'cortex-m0.cmake'}")
            # A cross build often runs with these set; they are not for the generator.
            os.environ["CXXFLAGS"] = "-mthumb"
        if options.ocm_generate:
            configure.append(f"-DOCM_GENERATE={options.ocm_generate}")
        run(*configure)
        os.environ.pop("CXXFLAGS", None)
        run("cmake", "--build", build)

        header = build / "ocm_topics" / "firmware" / "theirs.hpp"
        golden = (options.source / "tests" / "generator" / "golden" / "ferry.hpp").read_text()
        first = header.read_text()
        expect("the header is the golden one", first == golden.replace("from topics.json", "from theirs.json"))
        expect("a header's own name is used", (build / "ocm_topics/firmware/robot/again.hpp").read_text() == first)
        firmware = build / "firmware"
        if options.arm:
            expect("the firmware is for ARM", "ARM" in run("readelf", "-h", firmware))
            host = build / "ocm-generate-host" / "ocm-generate"
            if not options.ocm_generate:
                expect("the generator runs here", "ocm-generate" in run(host, "--version"))
        else:
            run(firmware)

        good = spec.read_text()
        spec.write_text(good.replace('"id": "0xA0"', '"id": "0xA1"'))
        run("cmake", "--build", build)
        expect("a changed spec gives a changed header", "TopicId id{0xA1}" in header.read_text())

        before = header.read_text()
        spec.write_text(good.replace('"id": "0xA0"', '"id": "0xA00"'))
        said = run("cmake", "--build", build, fails=True)
        expect("the build says what is wrong", '/topics/0/id: "0xA00" is wider than 8 bits' in said)
        expect("the old header is untouched", header.read_text() == before)

        spec.write_text(good)
        run("cmake", "--build", build)
        expect("the mended spec gives the first header", header.read_text() == first)


main()
