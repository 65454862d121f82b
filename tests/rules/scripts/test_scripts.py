"""scripts/ as its user meets it: a misspelt word costs no build, a signal leaves nothing running, two at once take turns, and
the summary of scripts/test names what does not build.

Each runs in a copy of the little that it reads, where cmake, ctest and apt-get are stand-ins: nothing is built or installed.
"""

import concurrent.futures
import contextlib
import importlib.machinery
import importlib.util
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

ROOT = pathlib.Path(os.environ["OCM_SOURCE_DIR"])
sys.path.insert(0, str(ROOT / "tests"))
import waiting
BUILDERS = ("cmake", "ctest", "apt-get", "sudo", "npm", "ninja")


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ocm-scripts-")
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name) / "tree"
        for part in ("scripts", "bench", "tests/robustness/fuzz/targets"):
            shutil.copytree(ROOT / part, self.tree / part)
        for file in ("tests/runs.py", "tests/rules/architecture/house.py"):
            (self.tree / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / file, self.tree / file)
        self.programs = pathlib.Path(folder.name) / "bin"
        self.programs.mkdir()
        for name in BUILDERS:
            self.stand_in(name, f"echo {name} >>{self.tree}/called; exit 1")

    def stand_in(self, name, text, folder=None):
        path = (folder or self.programs) / name
        path.write_text(f"#!/bin/bash\n{text}\n", encoding="utf-8")
        path.chmod(0o755)

    def run_script(self, name, *arguments, path=None, **variables):
        environment = dict(os.environ, PATH=f"{self.programs}:{os.environ['PATH']}", TMPDIR=str(self.programs)) | variables
        return subprocess.run([path or self.tree / "scripts" / name, *arguments], env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=False, timeout=60)


    def start(self, name, *arguments):
        """A script that gets signals also where this test was started with some of them ignored (nohup, &)."""
        def obey():
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, signal.SIG_DFL)

        environment = dict(os.environ, PATH=f"{self.programs}:{os.environ['PATH']}", TMPDIR=str(self.programs))
        return subprocess.Popen([self.tree / "scripts" / name, *arguments], env=environment, stdin=subprocess.DEVNULL, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True, preexec_fn=obey)


class Misspelt(Case):
    # Arguments, and the message.
    WORDS = {
        "bench": [("--lst", "no option '--lst'; did you mean '--list'?"), ("codc", "no benchmark 'codc'; did you mean 'codec'?")],
        "build": [("frimware", "no build 'frimware'; did you mean 'firmware'?"), ("--hlep", "no option '--hlep'; did you mean '--help'?"), ("x", "no build 'x'; there are firmware, avr, operator"),
                  ("-DA=1 firmware", "'firmware' comes first: scripts/build firmware [CMAKE ARGUMENT...]"),
                  ("-j2", "'-j2' is for cmake --build; how many files to compile at once: OCM_JOBS=2 scripts/build")],
        "demo": [("--hlep", "no option '--hlep'; did you mean '--help'?"),
                 ("now", "unexpected argument 'now'; it takes none, see scripts/demo --help")],
        "figures": [("--hlep", "no option '--hlep'; did you mean '--help'?"), ("nothing", "no folder 'nothing'; expected a build folder")],
        "fuzz": [("--lits", "no option '--lits'; did you mean '--list'?"), ("--list now", "'now' behind --list, which takes nothing; see scripts/fuzz --help"),
                 ("1s quantiti", "no target 'quantiti'; did you mean 'quantity'?"),
                 ("soon", "'soon' is no time above zero: 10, 10m or 90s; see scripts/fuzz --help")],
        "guest": [("--fecth", "no option '--fecth'; did you mean '--fetch'?"),
                  ("-q", "no option '-q'; there are -s DIR, -t SECONDS, -m SIZE, -v, --fetch, --help"),
                  ("-t", "-t needs a value; see scripts/guest --help"),
                  ("-t 5m true", "-t 5m: expected whole seconds above zero"), ("-t 0 true", "-t 0: expected whole seconds above zero"),
                  ("-m lots true", "-m lots: expected a size such as 384M or 2G"), ("-s /etc/passwd true", "-s /etc/passwd: no such folder")],
        "mutate": [("--room include/ocm/log --lst", "error: no option '--lst'; did you mean '--list'?"),
                   ("--rom x", "error: no option '--rom'; did you mean '--room'?"),
                   ("--room cli/../docs", "error: unsupported room 'docs': expected a folder or file of include/ocm, cli, generator or sim"),
                   ("--room scripts --jobs 0", "error: argument --jobs: '0': expected a whole number, 1 or more"),
                   ("--room scripts --number 3,x", "error: argument --number: 'x': expected a whole number, 1 or more")],
        "pictures": [("terminl", "no picture 'terminl'; did you mean 'terminal'?"), ("--hlep", "no option '--hlep'; did you mean '--help'?")],
        "setup": [("--lst", "no option '--lst'; did you mean '--list'?"), ("--list now", "'now' behind --list, which takes nothing; see scripts/setup --help"),
                  ("--tool now", "'now' behind --tool, which takes nothing; see scripts/setup --help"),
                  ("--all", "no option '--all'; there are --tool, --firmware, --avr, --operator, --pictures, --list, --help")],
        "suggest": [("word", "expected a word and the known ones; see scripts/suggest --help")],
        "test": [("--qiuck", "no option '--qiuck'; did you mean '--quick'?"),
                 ("style", "'style' is no option; only a part, or a test: scripts/test --only style"),
                 ("--only ,style", "an empty name in ',style'; see scripts/test --help")],
    }

    def test_an_empty_word_is_named_and_builds_nothing(self):
        for script, *words in (("bench",), ("build",), ("demo",), ("figures",), ("fuzz", "1s"), ("mutate",), ("pictures",), ("setup",), ("test",)):
            with self.subTest(script=script):
                done = self.run_script(script, *words, "")
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertRegex(done.stderr.splitlines()[-1], rf"^{script}: .*(''|an empty argument)")
                self.assertFalse((self.tree / "called").exists(), "nothing is built for it")

    def test_every_script_names_the_word_and_the_nearest(self):
        scripts = [path.name for path in (ROOT / "scripts").iterdir() if path.is_file() and os.access(path, os.X_OK)]
        self.assertEqual(sorted(scripts), sorted(self.WORDS), "each script has its words here")
        for script, cases in self.WORDS.items():
            for arguments, message in cases:
                with self.subTest(script=script, arguments=arguments):
                    done = self.run_script(script, *arguments.split())
                    self.assertEqual(done.returncode, 2, done.stderr)
                    self.assertEqual(done.stderr.splitlines()[-1], f"{script}: {message}")
                    self.assertFalse((self.tree / "called").exists(), "nothing is built for it")


class Mutate(Case):
    def mutate(self, tree, *rooms):
        return self.run_script("mutate", *(f"--room={room}" for room in rooms), "--count", "1", "--list", path=tree / "scripts" / "mutate")

    def test_each_file_has_tests_that_judge_it(self):
        done = self.mutate(ROOT, "include/ocm", "cli", "generator", "sim")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_file_without_a_judge_is_an_error(self):
        text = "#pragma once\ninline bool below(int a) { return a < 3; }\n"
        for path in ("include/ocm/base/unjudged.hpp", "cli/room/unjudged.cpp", "cli/verbs/unjudged.cpp", "sim/physics/unjudged.hpp"):
            (self.tree / path).parent.mkdir(parents=True, exist_ok=True)
            (self.tree / path).write_text(text, encoding="utf-8")
        done = self.mutate(self.tree, "include/ocm/base", "cli", "sim")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        expected = "expected an entry in JUDGES"
        for path, what in (("include/ocm/base/unjudged.hpp", "expected a source in tests/unit that includes it"),
                           ("sim/physics/unjudged.hpp", "expected a source in tests/sim that includes it"),
                           ("cli/room/unjudged.cpp", expected), ("cli/verbs/unjudged.cpp", expected)):
            self.assertIn(f"mutate: {path}: no test judges it; {what}", done.stderr.splitlines())


    def small_tree(self):
        """A header with some bugs to plant, and its test; what JUDGES names is that of the tree."""
        for folder in ("cli", "generator", "sim", "tests/tool"):
            (self.tree / folder).symlink_to(ROOT / folder)
        texts = {"include/ocm/base/below.hpp": "#pragma once\ninline bool below(int a) { return a < 3; }\n",
                 "tests/unit/base/below.cpp": '#include "ocm/base/below.hpp"\n', "tests/precompiled.hpp": "", "tests/main.cpp": ""}
        for path, text in texts.items():
            (self.tree / path).parent.mkdir(parents=True, exist_ok=True)
            (self.tree / path).write_text(text, encoding="utf-8")

    def test_a_number_that_the_set_has_not(self):
        self.small_tree()
        done = self.run_script("mutate", "--room", "include/ocm/base", "--number", "1,99", "--list")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr.splitlines()[-1], r"^mutate: error: argument --number: 99: the set has \d$")

    def test_what_a_library_is_made_of_is_judged_by_what_is_linked_with_it(self):
        path = str(ROOT / "scripts" / "mutate")
        spec = importlib.util.spec_from_file_location("mutate", path, loader=importlib.machinery.SourceFileLoader("mutate", path))
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        for made, library in (("cli/output/CMakeFiles/ocm_output_objects.dir/__/logs/json_lines.cpp.o", "ocm_output"),
                              ("cli/CMakeFiles/amiroctl_rooms.dir/Unity/unity_serve_cxx.cxx.o", "amiroctl_parts"),
                              ("cli/CMakeFiles/amiroctl_busy.dir/output/printer.cpp.o", "amiroctl_parts"),
                              ("generator/spec/CMakeFiles/ocm_spec.dir/schema.cpp.o", "ocm_spec")):
            self.assertEqual(module.library_of(made), library)

    def test_what_is_missing_or_fails_without_a_bug_is_named(self):
        self.small_tree()
        for compiler, message in (("echo out of memory >&2; exit 1", r"^mutate: 'g\+\+ .*precompiled.hpp.gch' failed:\nout of memory\n$"),
                                  (None, r"^mutate: g\+\+: No such file or directory\n$")):
            if compiler:
                self.stand_in("g++", compiler)
                path = os.environ["PATH"]
            else:
                (self.programs / "g++").unlink()
                (self.programs / "python3").symlink_to(sys.executable)
                (self.programs / "env").symlink_to(shutil.which("env"))
                path = ""
            with unittest.mock.patch.dict(os.environ, PATH=path):
                done = self.run_script("mutate", "--room", "include/ocm/base")
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, message)
            self.assertEqual(list((self.tree / "build-mutate").iterdir()), [], "and nothing is left")

    def test_ctrl_c_ends_what_runs_and_judges_no_more(self):
        self.small_tree()
        started = self.tree / "started"
        self.stand_in("g++", f"echo $$ >>{started}; exec sleep 600")
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)):
            with self.subTest(signal=number):
                started.unlink(missing_ok=True)
                process = self.start("mutate", "--room", "include/ocm/base")
                waiting.until(lambda: started.exists() and started.read_text(encoding="utf-8").endswith("\n"), "it has begun to compile")
                process.send_signal(number)
                self.assertEqual((process.communicate(timeout=60)[0], process.returncode), ("", code))
                self.assertFalse(Ended.runs(int(started.read_text(encoding="utf-8"))))
                self.assertEqual(list((self.tree / "build-mutate").iterdir()), [], "and nothing is left")


class Guest(unittest.TestCase):
    def test_the_name_of_a_shared_folder_is_no_command(self):
        with tempfile.TemporaryDirectory(prefix="it's$(id>&2);&") as folder:
            file = pathlib.Path(folder) / "word"
            file.write_text("hello\n", encoding="utf-8")
            done = subprocess.run([ROOT / "scripts" / "guest", "-s", folder, "cat", file], stdin=subprocess.DEVNULL, capture_output=True,
                                  text=True, check=False, timeout=250)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "hello\n", ""))


class Bench(Case):
    def test_the_list_needs_no_build(self):
        done = self.run_script("bench", "--list")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse((self.tree / "called").exists())
        listed = done.stdout.split()
        text = (ROOT / "bench" / "CMakeLists.txt").read_text(encoding="utf-8")
        built = set(re.findall(r"add_executable\(bench_(\w+)", text))
        built |= {name for names in re.findall(r"foreach\(name ([^)]*)\)", text) for name in names.split()}
        self.assertLessEqual(built, set(listed), "each program that is built")
        for name in ("start_up", "convert", "decode"):  # scripts, and folders with one
            self.assertIn(name, listed)
        self.assertEqual(listed, sorted(set(listed)))


class Build(Case):
    """Whatever an earlier run has left in build/."""

    def setUp(self):
        super().setUp()
        self.stand_in("setup", "", self.tree / "scripts")
        self.stand_in("cmake", f'echo "$@" >>{self.tree}/called')
        self.build = self.tree / "build"

    def called(self):
        return (self.tree / "called").read_text(encoding="utf-8").splitlines()

    def test_a_copied_tree_does_not_compile_the_original(self):
        self.build.mkdir()
        (self.build / "build.ninja").touch()
        (self.build / "CMakeCache.txt").write_text("CMAKE_HOME_DIRECTORY:INTERNAL=/the/original\n", encoding="utf-8")
        done = self.run_script("build")
        self.assertEqual(done.returncode, 1)
        self.assertIn("build/ compiles the sources in /the/original, not these; rm -rf build, and try again", done.stderr)
        self.assertFalse((self.tree / "called").exists())

    def test_its_own_folder_is_used_as_it_is_also_through_a_link(self):
        self.build.mkdir()
        (self.build / "build.ninja").touch()
        link = self.tree.parent / "link"
        link.symlink_to(self.tree)
        (self.build / "CMakeCache.txt").write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={link}\n", encoding="utf-8")
        self.assertEqual(self.run_script("build").returncode, 0)
        self.assertEqual([line.split()[0] for line in self.called()], ["--build"])

    def test_what_a_failed_configuration_has_found_out_is_forgotten(self):
        (self.build / "CMakeFiles").mkdir(parents=True)
        (self.build / "CMakeCache.txt").write_text("CMAKE_EXECUTABLE_FORMAT:INTERNAL=Unknown\n", encoding="utf-8")
        self.assertEqual(self.run_script("build").returncode, 0)
        self.assertEqual(sorted(path.name for path in self.build.iterdir()), [".lock"])
        self.assertEqual([line.split()[0] for line in self.called()], ["--preset", "--build"])

    def test_two_at_once_take_turns(self):
        """A stand-in of cmake that finds another one at work fails."""
        for program in ("clang++-14", "llvm-cov-14", "llvm-profdata-14"):
            self.stand_in(program, "")
        (self.tree / "build").mkdir()
        (self.tree / "build" / "build.ninja").touch()
        busy, waits = self.tree / "busy", self.tree / "waits"
        # It works until the other one has said that it waits.
        self.stand_in("cmake", f"mkdir {busy} || {{ touch {self.tree}/together; exit 1; }}\n"
                               f"for ((i = 0; i < 300; ++i)); do [ ! -e {waits} ] || break; sleep 0.1; done; rmdir {busy}")
        said = re.compile(r"(?m)^(build|bench|test|fuzz): waits for another build in build")
        for pair in ((("build",), ("bench", "codec")), (("build",), ("test", "--only", "release")), (("fuzz", "--build"), ("fuzz", "--build")),
                     (("build", "firmware"), ("build", "firmware"))):
            with self.subTest(pair=pair):
                waits.unlink(missing_ok=True)

                def printed_by(process):
                    lines = []
                    for line in process.stdout:
                        lines.append(line)
                        if said.match(line):
                            waits.touch()
                    process.wait(timeout=60)
                    process.stdout.close()
                    return "".join(lines)

                both = [self.start(*words) for words in pair]
                with concurrent.futures.ThreadPoolExecutor(2) as pool:
                    printed = "".join(pool.map(printed_by, both))
                self.assertFalse((self.tree / "together").exists(), printed)
                self.assertRegex(printed, said)

    def test_two_builds_at_once_take_turns(self):
        self.stand_in("cmake", f"echo begin >>{self.tree}/called; sleep 0.2; echo end >>{self.tree}/called")
        both = [subprocess.Popen([self.tree / "scripts" / "build"], env=dict(os.environ, PATH=f"{self.programs}:{os.environ['PATH']}"),
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for _ in range(2)]
        self.assertEqual([process.wait(timeout=60) for process in both], [0, 0])
        self.assertEqual(self.called(), ["begin", "end"] * 4)


class Configured(unittest.TestCase):
    def test_the_first_configuration_knows_every_test(self):
        """An option that is defined behind those who look at it counts from the second configuration on, and a fresh machine,
        which configures once, leaves their tests out without a word."""
        with tempfile.TemporaryDirectory(prefix="ocm-configured-") as folder:
            known = []
            for _ in range(2):
                subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"], check=True,
                               capture_output=True, timeout=120)
                listed = subprocess.run(["ctest", "--test-dir", folder, "-N"], check=True, capture_output=True, text=True, timeout=60)
                known.append(re.findall(r"Test +#\d+: (\S+)", listed.stdout))
            self.assertGreater(len(known[0]), 200)
            self.assertEqual(known[0], known[1])


class Ended(Case):
    """A script that is ended early by a signal that only it gets."""

    def test_it_ends_what_it_has_started(self):
        self.stand_in("setup", "", self.tree / "scripts")
        started = self.tree / "started"
        self.stand_in("cmake", f"sleep 600 & echo $$ $! >>{started}; wait")
        for program in ("clang++-14", "llvm-cov-14", "llvm-profdata-14"):
            self.stand_in(program, "")
        for script, *words in (("build",), ("build", "firmware"), ("bench", "codec"), ("fuzz", "1s"), ("test", "--only", "release"), ("demo",)):
            for number in (signal.SIGTERM, signal.SIGHUP):
                with self.subTest(script=script, words=words, signal=number):
                    started.unlink(missing_ok=True)
                    process = self.start(script, *words)
                    waiting.until(lambda: started.exists() and started.read_text(encoding="utf-8").endswith("\n"), f"{script} has begun to build")
                    process.send_signal(number)
                    process.communicate(timeout=60)
                    self.assertEqual(process.returncode, -number)
                    running = [int(word) for word in started.read_text(encoding="utf-8").split()]
                    waiting.until(lambda: not any(self.runs(each) for each in running), "what it has started has ended")

    @staticmethod
    def runs(process):
        try:
            return "(zombie)" not in pathlib.Path(f"/proc/{process}/status").read_text(encoding="utf-8")
        except FileNotFoundError:
            return False


class Setup(Case):
    def test_what_is_missing_is_named(self):
        for name in ("bash", "dirname", "readlink", "sed", "tr", "id"):
            if not (self.programs / name).exists():
                (self.programs / name).symlink_to(shutil.which(name))
        self.stand_in("dpkg-query", "for package; do echo installed $package; done")
        for gone, message in (("ninja", "setup: ninja is installed, but in no folder of PATH, which is "),
                              ("cmake", "setup: cmake is installed, but in no folder of PATH, which is "),
                              ("apt-get", "setup: there is no apt-get here; this script is made for Debian. Install what these packages hold: g++ cmake ")):
            (self.programs / gone).unlink()
            with unittest.mock.patch.dict(os.environ, PATH=""):
                done = self.run_script("setup", "--tool")
            self.assertEqual(done.returncode, 1)
            self.assertTrue(done.stderr.splitlines()[-1].startswith(message), done.stderr)


class Demo(Case):
    def test_what_is_set_for_a_real_robot_does_not_reach_it(self):
        self.stand_in("build", "", self.tree / "scripts")
        (self.tree / "build").mkdir()
        seen = self.tree / "seen"
        self.stand_in("amiroctl", f"env >>{seen}; exit 1", self.tree / "build")
        done = self.run_script("demo", AMIROCTL_DRY_RUN="true", AMIROCTL_SPEC="car.dbc", AMIROCTL_BUS="can0", XDG_CONFIG_HOME="/the/users")
        self.assertEqual((done.returncode, done.stderr), (1, "demo: the simulator ended; its message is above\n"))
        words = seen.read_text(encoding="utf-8").split("\n")
        self.assertEqual({word for word in words if word.startswith("AMIROCTL_")}, {"AMIROCTL_BUS=sim"})
        self.assertNotIn("XDG_CONFIG_HOME=/the/users", words)
        self.assertEqual([path.name for path in (self.tree / "build").iterdir()], ["amiroctl"], "and it leaves nothing")
        done = self.run_script("demo", TMPDIR="/no/such/folder")
        self.assertEqual((done.returncode, done.stderr),
                         (1, "demo: cannot make a folder in /no/such/folder: set TMPDIR to one that can be written\n"))


class Pictures(Case):
    def setUp(self):
        super().setUp()
        (self.tree / "build").mkdir()

    def test_in_a_path_with_blanks(self):
        self.tree = self.tree.rename(self.tree.parent / "tr\u00e4e of mine")
        self.stand_in("amiroctl", """printf '%s\\n' "$@"; env | grep AMIROCTL_""", self.tree / "build")
        self.stand_in("bash", f"exec {shutil.which('bash')} -c \"${{2/>\\/dev\\/null/}}\"")  # prints what the tool prints
        done = self.run_script("pictures", "worst_case", AMIROCTL_SPEC="car.dbc")
        words = done.stdout.splitlines()
        self.assertEqual(words, ["analyse", "bus", "--svg", str(self.tree / "docs" / "images" / "worst_case.svg")], done.stderr)

    SIGNALS = ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129))

    def ends(self, number, code, at_once):
        """Of a signal while the simulator runs, or `at_once` as it starts."""
        started = self.tree / "started"
        started.unlink(missing_ok=True)
        self.stand_in("amiroctl", f"""
            [ $1 = sim ] || exec sleep 600
            trap 'exit 130' INT  # bash goes on where a command of its script takes the signal
            {f"kill -{int(number)} $PPID" if at_once else ""}
            mkdir $XDG_RUNTIME_DIR/ocm; touch $XDG_RUNTIME_DIR/ocm/sim.sock; echo $$ >{started}; exec sleep 600""", self.tree / "build")
        process = self.start("pictures", "top")
        if not at_once:
            waiting.until(lambda: started.exists() and started.read_text(encoding="utf-8").endswith("\n"), "the simulator runs")
            process.send_signal(number)
        self.assertEqual(process.wait(timeout=60), code)
        if started.exists():  # not where it was ended before
            self.assertFalse(Ended.runs(int(started.read_text(encoding="utf-8"))))
        with contextlib.suppress(ProcessLookupError):  # the stand-in of a command, which would have ended by itself
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate(timeout=60)
        self.assertEqual([path.name for path in self.programs.glob("ocm-*")], [], "and nothing is left")

    def test_the_simulator_ends_with_it(self):
        for number, code in self.SIGNALS:
            for at_once in (False, True):
                with self.subTest(signal=number, at_once=at_once):
                    self.ends(number, code, at_once)


class Dates(Case):
    def test_a_file_of_cmake_that_is_dated_in_the_future_is_named(self):
        (self.tree / "cmake").mkdir()
        shutil.copy(ROOT / "cmake" / "OcmDates.cmake", self.tree / "cmake")
        late = self.tree / "generator" / "CMakeLists.txt"
        late.parent.mkdir()
        (self.tree / "build").mkdir()
        for file in (late, self.tree / "build" / "a.cmake", self.tree / "README.md"):
            file.touch()
            os.utime(file, times=(4e9, 4e9))
        command = ["cmake", "-P", self.tree / "cmake" / "OcmDates.cmake"]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual(done.returncode, 1)
        words = " ".join(done.stderr.split())
        self.assertIn(f"{late} is dated in the future: set this machine's clock, or touch that file", words)
        late.touch()
        self.assertEqual(subprocess.run(command, capture_output=True, check=False, timeout=60).returncode, 0)


class Everywhere(Case):
    def test_by_a_link_to_the_script_itself(self):
        for script in ("bench", "fuzz"):
            link = self.tree.parent / script
            link.symlink_to(self.tree / "scripts" / script)
            self.assertEqual(self.run_script(script, "--list", path=link).stdout, self.run_script(script, "--list").stdout)

    def test_how_many_at_once_is_a_number(self):
        for script, words in (("test", ("--only", "style")), ("fuzz", ("1s",)), ("build", ())):
            for jobs in ("0", "abc", "-1", "2x", "1000"):
                done = self.run_script(script, *words, OCM_JOBS=jobs)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(f"{script}: OCM_JOBS is '{jobs}'; expected a number from 1 to 999", done.stderr)

    def test_how_much_is_explored_is_a_number(self):
        for explore in ("0", "ten", "1000"):
            done = self.run_script("test", "--only", "style", OCM_EXPLORE=explore)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"test: OCM_EXPLORE is '{explore}'; expected a number from 1 to 999", done.stderr)


class WithoutGit(Case):
    """An archive of the tree, below another project's checkout."""

    def setUp(self):
        super().setUp()
        self.stand_in("setup", "", self.tree / "scripts")
        shutil.copy(ROOT / ".clang-format", self.tree)
        (self.tree / "cli").mkdir()
        (self.tree / "cli" / "wrong.cpp").write_text("int  a;\n", encoding="utf-8")
        subprocess.run(["git", "init", "-q", self.tree.parent], check=True)

    def test_style_checks_all_files(self):
        done = self.run_script("test", "--only", "style")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("wrong.cpp:1:4: error: code should be clang-formatted", done.stderr)

    def test_figures_count_all_files(self):
        done = self.run_script("figures")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"\n +1  cli \(1 files\)\n")

    def test_figures_that_cannot_be_written(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([self.tree / "scripts" / "figures"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (1, "figures: the output: No space left on device\n"))


class Summary(Case):
    def setUp(self):
        super().setUp()
        self.stand_in("setup", "", self.tree / "scripts")

    def test_what_does_not_configure_is_named(self):
        self.stand_in("cmake", r'[[ $* != *release* ]] || { printf "CMake Error at CMakeLists.txt:7 (message):\n  no such thing\n\n"; exit 1; }')
        done = self.run_script("test", "--only", "release")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout.split("--- summary ---")[1],
                         r"release, configure +FAILED +\d+ s\n    CMake Error at CMakeLists.txt:7 \(message\): no such thing\n")

    def test_tests_that_cannot_be_configured_leave_a_folder_without_them(self):
        cache = self.tree / "build" / "CMakeCache.txt"
        cache.parent.mkdir()
        self.stand_in("cmake", f"sed -i 's/OCM_TESTS:BOOL=.*/OCM_TESTS:BOOL=ON/' {cache}; exit 1")
        for had in ("OFF", "ON"):
            cache.write_text(f"A:BOOL=ON\nOCM_TESTS:BOOL={had}\nZ:BOOL=ON\n", encoding="utf-8")
            self.assertEqual(self.run_script("test", "--only", "release").returncode, 1)
            self.assertEqual(cache.read_text(encoding="utf-8"), f"A:BOOL=ON\nOCM_TESTS:BOOL={had}\nZ:BOOL=ON\n")

    def test_what_does_not_build_is_named(self):
        self.stand_in("ctest", """echo '{"tests": [{"name": "unit_can"}]}'""")
        self.stand_in("ninja", "")
        for printed, error in (("x.hpp:3:1: warning: w\nx.cpp:5:2: error: expected ;\ny.cpp:1:1: error: second", "x.cpp:5:2: error: expected ;"),
                               ("x.o: undefined reference to f", "x.o: undefined reference to f"), ("killed", "killed")):
            self.stand_in("cmake", f'[[ $* != *--build* ]] || {{ echo "[1/2] compiling"; echo "{printed}" >&2; exit 1; }}')
            done = self.run_script("test", "--only", "sanitize")
            self.assertEqual(done.returncode, 1)
            summary = done.stdout.split("--- summary ---")[1]
            self.assertRegex(summary, rf"sanitize, configure +passed +\d+ s\n(.*\n)*sanitize, build +FAILED +\d+ s\n    {re.escape(error)}\n")
            self.assertRegex(summary, r"\nall +FAILED")

    def test_without_shellcheck_style_fails(self):
        # A folder with all programs of this machine but that one.
        programs = self.tree.parent / "all"
        programs.mkdir()
        for folder in os.environ["PATH"].split(":"):
            for file in pathlib.Path(folder).iterdir() if pathlib.Path(folder).is_dir() else ():
                if file.name != "shellcheck" and not (programs / file.name).is_symlink():
                    (programs / file.name).symlink_to(file)
        shutil.copy(ROOT / ".clang-format", self.tree)
        subprocess.run(["git", "init", "-q", self.tree], check=True)
        for path, code in ((str(programs), 1), (os.environ["PATH"], 0)):
            with unittest.mock.patch.dict(os.environ, PATH=path):
                done = self.run_script("test", "--only", "style")
            self.assertEqual(done.returncode, code, done.stdout + done.stderr)
            self.assertEqual("style: shellcheck is missing, so no script was checked" in done.stdout, bool(code))

    def test_what_the_sanitizers_run_runs_once_by_day(self):
        self.stand_in("cmake", "")
        asked = self.tree / "asked"
        self.stand_in("ninja", "printf 'all:\\n  input: phony\\n    amiroctl\\n'")
        names = ", ".join(f'{{"name": "{name}"}}' for name in ("cli_set", "fuzz_replay", "sim", "unit_clock", "unit_protocol", "unit_top"))
        self.stand_in("ctest", f"""case $* in *json*) echo '{{"tests": [{names}]}}' ;; *) echo "$*" >>{asked} ;; esac""")
        for words, explore, left_out in (("release,sanitize", "1", "unit_top"), ("release,sanitize,fuzz", "1", "fuzz_replay|unit_top"),
                                         ("release,sanitize", "2", None), ("release", "1", None)):
            asked.unlink(missing_ok=True)
            self.run_script("test", "--only", words, OCM_EXPLORE=explore)
            first = asked.read_text(encoding="utf-8").splitlines()[0]
            self.assertIn("--preset release", first)
            self.assertEqual(first.partition(" -E ")[2], f"^({left_out})$" if left_out else "", words)

    def test_what_cmake_leaves_out_fails_a_run_of_all(self):
        self.stand_in("cmake", f"mkdir -p {self.tree}/build; printf 'qemu_*\\tno qemu-system-arm\\n' >{self.tree}/build/left_out.txt")
        self.stand_in("ctest", "exit 0")
        done = self.run_script("test", "--only", "release")
        self.assertEqual(done.returncode, 1)
        self.assertIn("  left out: qemu_*: no qemu-system-arm\n", done.stdout)

    def test_a_test_that_is_left_out_is_said_to_be(self):
        (self.tree / "build").mkdir()
        (self.tree / "build" / "left_out.txt").write_text("qemu_*\tno qemu-system-arm\n", encoding="utf-8")
        self.stand_in("cmake", "")
        self.stand_in("ctest", """echo '{"tests": [{"name": "unit_can"}]}'""")
        done = self.run_script("test", "--only", "qemu_boards")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stderr.splitlines()[-1],
                         "test: 'qemu_boards' is left out: no qemu-system-arm; scripts/setup installs what the tests need")

    def test_a_misspelt_part(self):
        self.stand_in("cmake", "")
        self.stand_in("ctest", """echo '{"tests": [{"name": "unit_can"}, {"name": "cli_style_x"}]}'""")
        for word, near in (("sty", "the part style, cli_style_x"), ("fzuz", "the part fuzz"), ("sanitise", "the part sanitize"), ("unit_cam", "unit_can")):
            done = self.run_script("test", "--only", word)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertRegex(done.stderr.splitlines()[-1], f"^test: no part and no test '{word}'; near it: .*{near}.*; "
                             "parts: release, sanitize, fuzz, style; all tests: ctest --preset release -N$")


if __name__ == "__main__":
    unittest.main()
