# SPDX-License-Identifier: Apache-2.0
"""Sweeps: many simulations of one scene as one data set that can be resumed.

It may import ``recording``, ``simulation`` and what lies below. xarray, zarr, pyarrow and dask
are imported where they are needed.
"""
