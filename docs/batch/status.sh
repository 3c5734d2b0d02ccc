#!/usr/bin/env bash
# State of a Slurm job in Snakemake's words, for --cluster-status: status.sh JOB prints success, running or failed.
# It asks the controller, so it needs no accounting database.
set -euo pipefail

# A controller that does not answer says nothing about the job: Snakemake asks again later.
if ! job=$(scontrol -o show job "$1" 2>&1); then
  [[ $job == *"Invalid job id"* ]] && echo failed || echo running
  exit 0
fi
state=${job#*JobState=}
case ${state%% *} in
  COMPLETED) echo success ;;
  PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | STOPPED | RESIZING | SIGNALING | STAGE_OUT | REQUEUE*)
    echo running ;;
  *) echo failed ;;
esac
