#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Run a sweep on a Dask cluster of two worker processes on this machine: `make sweep-demo`.

On many machines the cluster is another one, and nothing else changes: start ``dask scheduler`` on
one and ``dask worker tcp://HOST:8786 --nthreads 1 --nworkers -1`` on each, and give the command
``sweep`` the address, ``--dask tcp://HOST:8786``.
"""

import argparse

import distributed

from rigid_body_sim import sweep


def main():
    """Start the cluster, run the sweep, end the cluster."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('spec', help='YAML file of a sweep')
    parser.add_argument('store', help='folder to make or to go on with, NAME.zarr')
    parser.add_argument('--workers', type=int, default=2, help='processes (2)')
    options = parser.parse_args()
    with distributed.LocalCluster(n_workers=options.workers, threads_per_worker=1,
                                  dashboard_address=None) as cluster, \
            distributed.Client(cluster) as client:
        print(f'{cluster.scheduler_address}: {len(client.nthreads())} workers')
        print(sweep(options.spec, client, options.store, progress=True))


# Dask starts its workers with `spawn`, which imports this file again
if __name__ == '__main__':
    main()
