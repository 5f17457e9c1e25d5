# SPDX-License-Identifier: BSD-3-Clause
"""Files of Exodus II written for tests, in netCDF's classic format, after the manual (Schoof, Yarberry, SAND92-2137).

Needs scipy.
"""

import numpy as np
from scipy.io import netcdf_file

NAME = 33  # characters and a zero


def write(path, points, blocks, side_sets=(), node_sets=(), fields=None, dimension=3):
    """A mesh. Numbers are from 1.

    blocks: (name, type, elements' nodes); side_sets: (name, elements, sides); node_sets: (name, nodes);
    fields: {name: value of each node}, at one time.
    """
    with netcdf_file(path, "w", version=2) as file:
        file.api_version = file.version = np.float32(5.14)
        file.floating_point_word_size, file.file_size, file.title = np.int32(8), np.int32(1), b"test"
        file.createDimension("time_step", None)
        sizes = {"len_string": NAME, "len_name": NAME, "len_line": 81, "four": 4, "num_dim": dimension}
        sizes |= {"num_nodes": len(points), "num_elem": sum(len(b[2]) for b in blocks), "num_el_blk": len(blocks)}
        for name, size in sizes.items():
            file.createDimension(name, size)
        # Exodus 6.02 does not read the first variable of a file; the longest comes first here.
        array(file, "node_num_map", "i", ("num_nodes",), np.arange(1, len(points) + 1))
        for axis, values in zip("xyz"[:dimension], np.transpose(points)):
            array(file, f"coord{axis}", "d", ("num_nodes",), values)
        _put_blocks(file, blocks)
        if side_sets:
            _put_sets(file, "ss", "num_side_sets", [name for name, _, _ in side_sets])
            for k, (_, elements, sides) in enumerate(side_sets, 1):
                file.createDimension(f"num_side_ss{k}", len(elements))
                array(file, f"elem_ss{k}", "i", (f"num_side_ss{k}",), elements)
                array(file, f"side_ss{k}", "i", (f"num_side_ss{k}",), sides)
        if node_sets:
            _put_sets(file, "ns", "num_node_sets", [name for name, _ in node_sets])
            for k, (_, nodes) in enumerate(node_sets, 1):
                file.createDimension(f"num_nod_ns{k}", len(nodes))
                array(file, f"node_ns{k}", "i", (f"num_nod_ns{k}",), nodes)
        if fields:
            _put_fields(file, fields)


def array(file, name, kind, dimensions, values):
    variable = file.createVariable(name, kind, dimensions)
    variable[:] = values
    return variable


def names(file, variable, dimension, texts):
    table = np.zeros((len(texts), NAME), "S1")
    for row, text in zip(table, texts):
        row[: len(text)] = [letter.encode() for letter in text]
    array(file, variable, "c", (dimension, "len_name"), table)


def _put_blocks(file, blocks):
    array(file, "eb_status", "i", ("num_el_blk",), 1)
    array(file, "eb_prop1", "i", ("num_el_blk",), np.arange(10, 10 + len(blocks))).name = b"ID"
    names(file, "eb_names", "num_el_blk", [name for name, _, _ in blocks])
    for k, (_, type_, nodes) in enumerate(blocks, 1):
        file.createDimension(f"num_el_in_blk{k}", len(nodes))
        file.createDimension(f"num_nod_per_el{k}", len(nodes[0]))
        connectivity = array(file, f"connect{k}", "i", (f"num_el_in_blk{k}", f"num_nod_per_el{k}"), nodes)
        connectivity.elem_type = type_.encode()


def _put_sets(file, prefix, dimension, texts):
    file.createDimension(dimension, len(texts))
    array(file, f"{prefix}_status", "i", (dimension,), 1)
    array(file, f"{prefix}_prop1", "i", (dimension,), np.arange(1, 1 + len(texts))).name = b"ID"
    names(file, f"{prefix}_names", dimension, texts)


def _put_fields(file, fields):
    file.createDimension("num_nod_var", len(fields))
    names(file, "name_nod_var", "num_nod_var", list(fields))
    time = file.createVariable("time_whole", "d", ("time_step",))
    time[0] = 1.0
    for k, values in enumerate(fields.values(), 1):
        variable = file.createVariable(f"vals_nod_var{k}", "d", ("time_step", "num_nodes"))
        variable[0] = np.asarray(values)
