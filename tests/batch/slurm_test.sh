#!/usr/bin/env bash
# Subjects through docs/batch/Snakefile on a Slurm of one node: slurm_test.sh PROGRAMS, the folder of the built
# programs. The daemons run without systemd, keep all state in one temporary folder, and end with the test.
set -euo pipefail

# shellcheck source=tests/batch/batch_steps.sh
source "$(dirname "$0")/batch_steps.sh"
need snakemake oiiotool python3 munged slurmctld slurmd sbatch
need_colin27
((EUID == 0)) || skip "slurmd of a test needs root"

daemons=()
end_daemons() {
  local daemon deadline=$((SECONDS + 20))
  end_run
  if ((${#daemons[@]} == 3)); then  # the jobs end first: slurmd does not end them
    timeout 5 scancel --user=root 2>/dev/null || true
    while [[ $(timeout 5 squeue -h 2>/dev/null) ]] && ((SECONDS < deadline)); do sleep 0.2; done
  fi
  deadline=$((SECONDS + 10))
  for daemon in "${daemons[@]}"; do
    kill "$daemon" 2>/dev/null || true
  done
  for daemon in "${daemons[@]}"; do
    while kill -0 "$daemon" 2>/dev/null && ((SECONDS < deadline)); do sleep 0.1; done
    kill -KILL "$daemon" 2>/dev/null || true
  done
}

# await WHAT COMMAND...: until the command succeeds, for at most a minute.
await() {
  local what=$1 deadline=$((SECONDS + 60))
  shift
  until "$@"; do
    ((SECONDS < deadline)) || fail "$what: not within a minute"
    sleep 0.1
  done
}

make_folder
trap 'end_daemons; end_batch' EXIT
cd "$folder"

start_slurm() {
  local host ports
  host=$(hostname -s)
  # Two ports that are free now: other daemons of this kind may run here.
  ports=$(python3 -c '
import socket
sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
print(*(s.getsockname()[1] for s in sockets))')
  mkdir slurm slurm/state slurm/spool
  head -c 1024 /dev/urandom >slurm/munge.key
  chmod 400 slurm/munge.key
  chmod 755 "$folder" slurm  # clients look for the socket of munged
  cat >slurm/slurm.conf <<CONF
ClusterName=batch
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports% *}
SlurmdPort=${ports#* }
SlurmUser=root
SlurmdUser=root
AuthInfo=socket=$folder/slurm/munge.socket
StateSaveLocation=$folder/slurm/state
SlurmdSpoolDir=$folder/slurm/spool
SlurmctldPidFile=$folder/slurm/slurmctld.pid
SlurmdPidFile=$folder/slurm/slurmd.pid
SlurmctldLogFile=$folder/slurm/slurmctld.log
SlurmdLogFile=$folder/slurm/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
ReturnToService=2
KillWait=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=2000
PartitionName=all Nodes=ALL Default=YES
CONF
  export SLURM_CONF=$folder/slurm/slurm.conf
  # In the foreground each is a child of this script, so its process is known. In sessions of their own they outlive
  # a signal to the group of this script, and can still end the jobs.
  setsid munged --force --foreground --key-file=slurm/munge.key --socket="$folder/slurm/munge.socket" \
    --pid-file="$folder/slurm/munged.pid" --log-file="$folder/slurm/munged.log" \
    --seed-file="$folder/slurm/munged.seed" >slurm/munged.out 2>&1 &
  daemons+=($!)
  await "munged" test -S slurm/munge.socket
  setsid slurmctld -D >slurm/slurmctld.out 2>&1 &
  daemons+=($!)
  setsid slurmd -D >slurm/slurmd.out 2>&1 &
  daemons+=($!)
  await "an idle node" node_is_idle
}
node_is_idle() { [[ $(sinfo -h -o %T 2>/dev/null) == idle ]]; }

# The command of docs/batch/README.md, and less memory than a test machine has.
on_slurm=(--jobs 2
  --cluster "sbatch --parsable -c {threads} --mem={resources.mem_mb} -t {resources.runtime} -o logs/slurm-%j.log"
  --cluster-status "$(realpath "$here/../../docs/batch/status.sh")" --cluster-cancel scancel
  --set-resources build:mem_mb=500 picture:mem_mb=500)

start_slurm
say "Slurm runs"
/usr/bin/python3 "$here/make_subjects.py" make subjects 2
run subjects local -j 2 || fail "the run without Slurm failed"
run subjects library "${on_slurm[@]}" || fail "the run on Slurm failed"
for result in s01.atlas s02.atlas volumes.csv contact_sheet.png; do
  cmp "local/$result" "library/$result" || fail "$result differs from the one made without Slurm"
done
jobs=$(file_count library/logs 'slurm-*.log')
((jobs >= 4)) || fail "only $jobs steps ran on Slurm"
say "two subjects, $jobs jobs"

# A program that waits in place of the build, so that the job can be cancelled.
mkdir slow
ln -s "$programs/splatlas-player" slow/
printf '#!/bin/sh\nexec sleep 300\n' >slow/splatlas-preprocess
chmod +x slow/splatlas-preprocess
programs=$folder/slow
mkdir one
cp -r subjects/s01 one
start one cancelled "${on_slurm[@]}"
running_job() { job=$(squeue -h -t RUNNING -o %A) && [[ -n $job ]]; }
await "a running job" running_job
scancel "$job"
deadline=$((SECONDS + 60))
while kill -0 "$batch" 2>/dev/null; do
  ((SECONDS < deadline)) || fail "the run goes on after its job was cancelled"
  sleep 0.2
done
wait "$batch" && fail "the run with a cancelled job ended well"
batch=
grep -q "^s01: build failed" "$log" || fail "the cancelled subject is not named"
[[ $(file_count cancelled/ '*.atlas') == 0 ]] || fail "a cancelled build left an atlas"

say "passed"
