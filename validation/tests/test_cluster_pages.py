"""The pages about schedulers: every command on them runs, with little programs in place of the schedulers'."""

import ast
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tyndall import program
from validation.cluster import cli
from validation.places import CROSSCHECK, ROOT
from validation.tests.test_cluster import equal

PAGES = ROOT / "validation" / "cluster"
SBATCH = """#!/bin/bash -e
for word in "$@"; do case $word in *.sbatch) script=$word;; esac; last=$word; done
if [ "$script" ]; then
    echo 7
    for id in $(seq 0 15); do SLURM_ARRAY_TASK_ID=$id bash -e "$script" >&2; done
else
    case "$*" in *afterok:7*) sh -ec "$last" >&2;; esac
fi
"""
"""Runs an array at once, and what depends on it."""
CUECMD = """#!/bin/bash -e
while read -r line; do sh -ec "$line" </dev/null; done <"$1"
"""
CURL = """#!/bin/bash -e
while [ "$1" != --data ]; do shift; done
printf %s "$2" >job.json
"""
FLAMENCO = """
const commands = [];
const author = {
    Command: (name, words) => ({name, ...words}),
    Task: (name, type) => ({name, type, commands: [], addCommand(c) { this.commands.push(c) }, addDependency(t) { if (!t) throw name }}),
};
const job = {settings: JSON.parse(process.argv[1]), addTask(task) { commands.push(...task.commands) }};
compileJob(job);
console.log(JSON.stringify(commands));
"""
"""What Flamenco's manager gives to a job type; prints the commands of all tasks."""


def blocks(page: str, language: str) -> list[str]:
    """What stands between fences."""
    return re.findall(rf"^```{language}\n(.*?)^```", (PAGES / page).read_text(), re.DOTALL | re.MULTILINE)


def commands(page: str) -> list[str]:
    """The commands that stand indented or in the middle of a line."""
    text = (PAGES / page).read_text()
    return re.findall(r"^    (.+)$", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with fog.json, tiny, and the schedulers' programs."""
    programs = tmp_path / "programs"
    programs.mkdir()
    scene = json.loads((CROSSCHECK / "cube_in_room.json").read_text())
    scene["sensor"]["film"] |= {"width": 6, "height": 4}
    (tmp_path / "fog.json").write_text(json.dumps(scene))
    (programs / "tyndall").symlink_to(program.binary().absolute())
    python = f'#!/bin/sh\nexec {shlex.quote(sys.executable)} "$@"\n'  # this environment: a test makes none
    for name, text in (("python3", python), ("sbatch", SBATCH), ("srun", '#!/bin/sh\nexec "$@"\n'), ("cuecmd", CUECMD), ("curl", CURL)):
        (programs / name).write_text(text)
        (programs / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{programs}:{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def shell(script: str) -> None:
    """Runs a block of a page."""
    done = subprocess.run(["bash", "-euc", script], capture_output=True, text=True)
    assert done.returncode == 0, f"{script}\n{done.stdout}{done.stderr}"


def single(desk: Path, *options: str) -> Path:
    """What the pages promise, of an image so small that its pilot would be shorter than those of parts."""
    shell(shlex.join(["tyndall", "-q", "render", "fog.json", "--samples", "0..4096", "--sums", "single.sums", "-o", "single.exr", *options]))
    return desk / "single.exr"


def test_slurm(desk: Path) -> None:
    script, submit, so_far = blocks("slurm.md", "bash")
    (desk / "part.sbatch").write_text(script)
    shell(submit)
    assert equal(desk / "fog.exr", single(desk))
    shell(so_far)
    assert equal(desk / "so_far.exr", desk / "fog.exr")
    assert "--array=0-15" in script and 16 * int(re.findall(r"samples=(\d+)", script)[0]) == 4096
    shell(submit.replace("mkdir -p parts", "echo ok"))


def test_opencue(desk: Path) -> None:
    for block in blocks("opencue.md", "bash"):
        shell(block)
    assert equal(desk / "fog.exr", single(desk))
    assert len((desk / "fog.txt").read_text().splitlines()) == 64


def test_flamenco(desk: Path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("no `node` is installed")
    [job_type], [submit, so_far] = blocks("flamenco.md", "javascript"), blocks("flamenco.md", "bash")
    shell(submit.replace("/shared", str(desk)))
    told = json.loads((desk / "job.json").read_text())
    assert told["type"] == "tyndall" and told["settings"].keys() == set(re.findall(r'key: "(\w+)"', job_type))
    made = subprocess.run([node, "-e", job_type + FLAMENCO, json.dumps(told["settings"])], capture_output=True, text=True, check=True)
    for command in json.loads(made.stdout):
        assert command["name"] == "exec"
        shell(shlex.join([command["exe"], *command["args"]]))
    assert equal(desk / "fog.exr", single(desk, "--seed", "1"))
    shell(so_far.replace("/shared", str(desk)))


def test_the_commands_of_the_first_page_parse(desk: Path) -> None:
    found = [shlex.split(line) for line in commands("README.md")]
    ours = [words[3:] for words in found if words[:3] == ["python3", "-m", "validation.cluster"]]
    assert len(ours) == 4 and len(found) == 6
    for words in ours:
        options, more = cli.parser().parse_known_args(words)
        assert options.command.__name__ == f"run_{words[0]}" and more in ([], ["--seconds", "30"], [">", "fog.txt"])


@pytest.mark.parametrize(("number", "words"), [(0, ["--cpus-per-task=16", "-t 04:00:00"]), (1, ["select=1:ncpus=16:mem=16gb", "walltime=04:00:00"])])
def test_queues_get_jobs_of_one_task_and_many_processors(number: int, words: list[str]) -> None:
    tree = ast.parse(blocks("README.md", "python")[number])
    pytest.importorskip("dask_jobqueue", reason="`dask-jobqueue` is not installed: python3 -m validation.cluster render ... installs it")
    made: dict[str, Any] = {}
    tree.body = [step for step in tree.body if isinstance(step, (ast.ImportFrom, ast.Assign))]
    exec(compile(tree, "README.md", "exec"), made)
    try:
        script = made["cluster"].job_script()
    finally:
        made["cluster"].close()
    assert all(word in script for word in [*words, "--nthreads 1 "]), script
    options, more = cli.parser().parse_known_args([*made["render"][3:], "--scheduler", "tcp://here:1"])
    assert not more and options.spp == 4096
