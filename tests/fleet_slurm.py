#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""A fleet under a real Slurm on this machine, with what goes wrong in a cluster, against a plain loop.

Needs root, slurm-wlm, munge and parallel (`./dev fleet` installs them). Not part of CI: it takes minutes.

    fleet_slurm.py ADIT [--recordings DIR] [--sessions N] [--duration S]

Checks that the map and the products have the same bytes under Slurm, GNU parallel with one and two
workers, and a loop, where one shard is killed, one requeued, the node drained and resumed, one recording
damaged, and the disk full once; that nothing ran twice without need; and which shards run after a change.
"""
import argparse
import contextlib
import filecmp
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

CONF = """ClusterName=adit
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
ReturnToService=2
MpiDefault=none
SchedulerParameters=bf_interval=2
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName=localhost NodeAddr=127.0.0.1 CPUs=2 CoresPerSocket=2 RealMemory=8000
PartitionName=all Nodes=localhost Default=YES MaxTime=INFINITE State=UP
"""


def say(text):
    print(f"{time.strftime('%H:%M:%S')} {text}", flush=True)


def run(*words, check=True, **more):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, **more)
    if check and done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done


@contextlib.contextmanager
def slurm(folder):
    """A cluster of one node; its commands find it by the environment."""
    for name in ("state", "spool"):
        (folder / name).mkdir(parents=True)
    (folder / "slurm.conf").write_text(CONF.format(folder=folder))
    (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
    os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
    if run("pgrep", "-x", "munged", check=False).returncode != 0:
        for place in ("/run/munge", "/var/log/munge", "/var/lib/munge"):
            pathlib.Path(place).mkdir(parents=True, exist_ok=True)
            shutil.chown(place, "munge", "munge")
        run("runuser", "-u", "munge", "--", "/usr/sbin/munged")
    daemons = [subprocess.Popen([program, "-D", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
               for program, *words in (("slurmctld",), ("slurmd", "-N", "localhost"))]
    try:
        for _ in range(60):
            if "idle" in run("sinfo", "-h", "-o", "%T", check=False).stdout:
                break
            time.sleep(1)  # between looks
        else:
            sys.exit("the cluster does not come up: " + (folder / "slurmctld.log").read_text()[-2000:])
        yield
    finally:
        for daemon in daemons:
            daemon.terminate()
            daemon.wait()


def standing(adit, plan):
    return json.loads(run(adit, "plan", plan, "--json").stdout)["shards"]


def wait_for(condition, what, seconds=3600):
    for _ in range(seconds):
        if condition():
            return
        time.sleep(1)  # between looks
    sys.exit(f"{what} did not come about")


def running_shards(stage="map"):
    """Process ids of `adit shard` in a stage."""
    return [int(pid) for pid in run("pgrep", "-f", f"adit.* shard .* --stage {stage}", check=False).stdout.split()
            if "sh" != pathlib.Path(f"/proc/{pid}/comm").read_text().strip()]


def disturb(adit, plan):
    """Kills one shard, requeues another, drains the node and resumes it, while the maps are made."""
    wait_for(lambda: running_shards(), "a shard under Slurm")
    time.sleep(2)  # so that the shard has begun its work
    victim = running_shards()[0]
    os.kill(victim, signal.SIGKILL)
    say(f"killed process {victim}")
    wait_for(lambda: sum(shard["state"] == "done" for shard in standing(adit, plan)) >= 4, "four maps")
    jobs = run("squeue", "-h", "-r", "-t", "R", "-o", "%A_%a %i").stdout.split("\n")[0].split()
    run("scontrol", "requeue", jobs[-1])
    say(f"requeued {jobs[-1]}")
    wait_for(lambda: sum(shard["state"] == "done" for shard in standing(adit, plan)) >= 8, "eight maps")
    run("scontrol", "update", "nodename=localhost", "state=drain", "reason=test")
    say("drained the node")
    wait_for(lambda: not run("squeue", "-h", "-t", "R").stdout.strip(), "an empty node")
    done = sum(shard["state"] == "done" for shard in standing(adit, plan))
    time.sleep(5)  # as long as Slurm takes to start a job
    assert sum(shard["state"] == "done" for shard in standing(adit, plan)) == done, "a drained node works on"
    run("scontrol", "update", "nodename=localhost", "state=resume")
    say(f"resumed it, {done} shards are done")


def under_slurm(adit, fleet, plan):
    run(adit, "plan", fleet, "-o", plan, "--slurm", "--cores", "1")
    begin = time.monotonic()
    print(run("sh", plan / "submit.sh").stdout, end="")
    disturb(adit, plan)
    wait_for(lambda: not run("squeue", "-h").stdout.strip(), "the end of all jobs")
    return time.monotonic() - begin


def by_parallel(adit, fleet, plan, workers):
    run(adit, "plan", fleet, "-o", plan, "--parallel", "--at-once", workers)
    begin = time.monotonic()
    run("sh", plan / "run_parallel.sh", check=False)
    return time.monotonic() - begin


def by_loop(adit, fleet, plan):
    """With a disk that is full at first."""
    run(adit, "plan", fleet, "-o", plan)
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as small:
        run("mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", small)
        try:
            full = run(adit, "shard", plan, "0", check=False, env={**os.environ, "TMPDIR": small})
            assert full.returncode == 75, f"full disk: exit {full.returncode}\n{full.stdout}{full.stderr}"
            say("full disk: " + full.stderr.strip())
        finally:
            run("umount", small)
    run(adit, "shard", plan, "--all", check=False)
    return time.monotonic() - begin


def files_of(plan):
    return sorted(path.relative_to(plan) for top in ("site", "delivery", "ties") for path in (plan / top).rglob("*")
                  if path.is_file()) + [pathlib.Path("report.md")]


def require_same(one, other):
    assert files_of(one) == files_of(other), (one, other)
    different = [str(name) for name in files_of(one) if not filecmp.cmp(one / name, other / name, shallow=False)]
    assert not different, f"{one.name} and {other.name} differ in {different}"
    say(f"{one.name} and {other.name}: the same bytes in {len(files_of(one))} files")


def summary(adit, plan):
    print(run(adit, "plan", plan, "--status").stdout, end="", flush=True)


def ran_since(adit, plan, before):
    return [shard["id"] for shard in standing(adit, plan) if shard["starts"] > before.get(shard["id"], 0)]


def simulate(adit, folder, sessions, duration):
    for k in range(sessions):
        run(adit, "simulate", "city", "--seed", 7002, "--noise-seed", 100 + k, "--later", 60 * k, "--begin",
            120 * k, "--duration", duration, "--speed", 8, "--gnss", "single", "--quiet", "-o", folder / f"rec_{k:02}.mcap")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("adit", type=lambda text: pathlib.Path(text).absolute())
    parser.add_argument("--recordings", type=pathlib.Path, help="a folder with rec_*.mcap instead of simulating them")
    parser.add_argument("--sessions", type=int, default=24)
    parser.add_argument("--duration", type=int, default=30)
    given = parser.parse_args()
    adit = given.adit
    with tempfile.TemporaryDirectory(prefix="adit-fleet-") as name:
        folder = pathlib.Path(name)
        source = given.recordings.absolute() if given.recordings else folder
        if not given.recordings:
            simulate(adit, folder, given.sessions, given.duration)
        else:
            for path in sorted(source.glob("rec_*.mcap")):
                (folder / path.name).symlink_to(path)
        recordings = sorted(folder.glob("rec_*.mcap"))
        (folder / "damaged.mcap").write_bytes(recordings[3].read_bytes()[500_000:3_000_000])
        recordings[-1].rename(folder / "late.mcap")
        fleet = folder / "fleet.toml"
        fleet.write_text('recordings = ["rec_*.mcap", "damaged.mcap"]\n')

        with slurm(folder / "slurm"):
            seconds = {"slurm": under_slurm(adit, fleet, folder / "slurm_plan")}
        summary(adit, folder / "slurm_plan")
        shards = standing(adit, folder / "slurm_plan")
        assert [shard["id"] for shard in shards if shard["state"] != "done"] == ["map-damaged"], shards
        twice = [shard["id"] for shard in shards if shard["starts"] > 1]
        say(f"begun more than once: {twice}")
        assert len(twice) <= 3, "only those that were killed or requeued"
        assert "| damaged | - | - | failed |" in (folder / "slurm_plan/report.md").read_text()

        for workers in (1, 2):
            seconds[f"parallel {workers}"] = by_parallel(adit, fleet, folder / f"parallel_{workers}", workers)
            require_same(folder / "slurm_plan", folder / f"parallel_{workers}")
        seconds["loop"] = by_loop(adit, fleet, folder / "loop")
        require_same(folder / "slurm_plan", folder / "loop")
        say(", ".join(f"{name} {value:.0f} s" for name, value in seconds.items()))

        plan = folder / "loop"
        before = {shard["id"]: shard["starts"] for shard in standing(adit, plan)}
        fleet.write_text('recordings = ["rec_*.mcap", "damaged.mcap", "late.mcap"]\n')
        run(adit, "plan", fleet, "-o", plan)
        ties = len(list((plan / "ties").iterdir()))
        run(adit, "shard", plan, "--all", check=False)
        ran = ran_since(adit, plan, before)
        say(f"one recording more: {ran}; {len(list((plan / 'ties').iterdir())) - ties} pairs searched")
        assert [name for name in ran if name.startswith("map-")] == ["map-late"]

        before = {shard["id"]: shard["starts"] for shard in standing(adit, plan)}
        preset = run(adit, "deliver", "--print-preset").stdout.replace("--raster height --cell 0.25",
                                                                       "--raster height --cell 0.5")
        (folder / "ours.toml").write_text(preset)
        fleet.write_text(fleet.read_text() + '[deliver]\npreset = "ours.toml"\n')
        run(adit, "plan", fleet, "-o", plan)
        run(adit, "shard", plan, "--all", check=False)
        ran = ran_since(adit, plan, before)
        say(f"one setting of a product changed: {ran}")
        assert ran in (["product-height.tif"], ["product-height.tif", "report"]), ran
    print("fleet_slurm: all as it should be")


if __name__ == "__main__":
    main()
