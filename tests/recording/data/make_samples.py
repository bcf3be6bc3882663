#!/usr/bin/env python3
"""Writes the samples of this folder with programs that are not ours.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy h5py hdf5storage pyuff
    /tmp/venv/bin/python tests/recording/data/make_samples.py tests/recording/data

All hold the same 32 samples at 1 kHz, so that one test serves all: at sample k

    z(k) = 1.5 sin(0.3 k) mm, az(k) = -0.25 cos(0.2 k) g, fz(k) = 0.2 sin(0.1 k) kN
"""
import pathlib
import sys

import hdf5storage
import numpy as np
import pyuff
import scipy.io

folder = pathlib.Path(sys.argv[1])
k = np.arange(32)
time = k / 1000
z = 1.5 * np.sin(0.3 * k)  # mm
az = -0.25 * np.cos(0.2 * k)  # g
fz = 0.2 * np.sin(0.1 * k)  # kN

# MATLAB 5: vectors of the channels' own names; SI, for the file states no units.
scipy.io.savemat(folder / "scipy_vectors.mat", {
    "time": time, "mobile_1_z": z / 1e3, "mobile_1_az": (az * 9.80665).astype(np.float32), "load_fz": fz * 1e3,
    "fs": 1000.0, "comment": "sine", "complex_one": np.array([1 + 2j, 3j])}, do_compression=True)
# MATLAB 5: a structure with a matrix and lists of names and units.
scipy.io.savemat(folder / "scipy_matrix.mat", {"run": {
    "data": np.column_stack([time * 1e3, z, az, fz]), "names": np.array(["t", "LVDT top", "A1", "Force"], dtype=object),
    "units": np.array(["ms", "mm", "g", "kN"], dtype=object), "operator": "nobody"}}, do_compression=False)
# MATLAB 5: an array of structures, a channel each, as acquisition programs export.
channel = np.zeros(4, dtype=[("name", object), ("unit", object), ("data", object)])
for i, (name, unit, data) in enumerate([("Time", "s", time), ("LVDT top", "mm", z), ("A1", "g", az),
                                        ("Force", "kN", fz)]):
    channel[i] = (name, unit, data)
scipy.io.savemat(folder / "scipy_channels.mat", {"channel": channel, "version": 2.0})
# MATLAB 7.3 (HDF5): the same structure.
for old in folder.glob("hdf5storage_*.mat"):
    old.unlink()
hdf5storage.savemat(str(folder / "hdf5storage_matrix.mat"), {"run": {
    "data": np.column_stack([time * 1e3, z, az, fz]), "names": np.array(["t", "LVDT top", "A1", "Force"], dtype=object),
    "units": np.array(["ms", "mm", "g", "kN"], dtype=object)}, "fs": 1000.0}, format="7.3", store_python_metadata=False)
hdf5storage.savemat(str(folder / "hdf5storage_vectors.mat"), {
    "time": time, "mobile_1_z": z / 1e3, "mobile_1_az": az * 9.80665, "load_fz": fz * 1e3}, format="7.3",
    store_python_metadata=False)


# Universal file 58, ASCII and binary, single and double precision; a frequency response among the functions.
def write_uff(name, binary, double):
    path = folder / name
    path.unlink(missing_ok=True)
    file = pyuff.UFF(str(path))
    file.write_sets({"type": 164, "units_code": 1, "units_description": "SI", "temp_mode": 1, "length": 1.0, "force": 1.0,
                     "temp": 1.0, "temp_offset": 273.15}, "add")
    for node, direction, values, unit, kind, title in ((12, 3, z, "mm", 8, "LVDT top"), (7, -3, az, "g", 12, "A1"),
                                                       (1, 3, fz * 1e3, "NONE", 13, "Force")):
        file.write_sets({"type": 58, "func_type": 1, "rsp_node": node, "rsp_dir": direction, "ref_node": 0, "ref_dir": 0,
                         "rsp_ent_name": "NONE", "ref_ent_name": "NONE", "data": values, "x": time, "id1": title,
                         "id2": "NONE", "id3": "NONE", "id4": "NONE", "id5": "NONE", "load_case_id": 0, "binary": binary,
                         "ord_data_type": 4 if double else 2, "abscissa_spec_data_type": 17, "abscissa_axis_units_lab": "s",
                         "abscissa_axis_lab": "time", "ordinate_spec_data_type": kind, "ordinate_axis_lab": title,
                         "ordinate_axis_units_lab": unit, "abscissa_inc": 1e-3, "abscissa_min": 0.0, "abscissa_spacing": 1,
                         "orddenom_spec_data_type": 0}, "add", force_double=double)
    file.write_sets({"type": 58, "func_type": 4, "rsp_node": 12, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3,
                     "rsp_ent_name": "NONE", "ref_ent_name": "NONE", "data": np.exp(1j * k), "x": k * 1.0, "id1": "FRF",
                     "id2": "NONE", "id3": "NONE", "id4": "NONE", "id5": "NONE", "load_case_id": 0, "binary": binary,
                     "ord_data_type": 6 if double else 5, "abscissa_spec_data_type": 18, "ordinate_spec_data_type": 12,
                     "abscissa_inc": 1.0, "abscissa_min": 0.0, "abscissa_spacing": 1, "orddenom_spec_data_type": 13}, "add",
                    force_double=double)


write_uff("pyuff_ascii.uff", 0, True)
write_uff("pyuff_ascii_single.uff", 0, False)
write_uff("pyuff_binary.uff", 1, True)
write_uff("pyuff_binary_single.uff", 1, False)


# pyuff writes doubles whatever the header says: single precision and the other byte order by hand, from the description.
def write_big_endian(name):
    with open(folder / name, "wb") as file:
        for node, direction, values, unit, kind, title in ((12, 3, z, "mm", 8, "LVDT top"), (7, -3, az, "g", 12, "A1"),
                                                           (1, 3, fz, "kN", 13, "Force")):
            lines = [f"{-1:6d}", f"{58:6d}b{2:6d}{2:6d}{11:12d}{4 * len(values):12d}{0:6d}{0:6d}{0:12d}{0:12d}"]
            lines += [f"{text:80s}" for text in (title, "NONE", "NONE", "NONE", "NONE")]
            lines += [f"{1:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{node:10d}{direction:4d} {'NONE':10s}{0:10d}{0:4d}",
                      f"{2:10d}{len(values):10d}{1:10d}{0:13.5e}{1e-3:13.5e}{0:13.5e}"]
            lines += [f"{kind:10d}{0:5d}{0:5d}{0:5d} {label:20s} {unit:20s}"
                      for kind, label, unit in ((17, "time", "s"), (kind, title, unit), (0, "NONE", "NONE"),
                                                (0, "NONE", "NONE"))]
            file.write("\r\n".join(lines).encode() + b"\r\n" + values.astype(">f4").tobytes() + b"\r\n    -1\r\n")


write_big_endian("big_endian_single.uff")


# LabVIEW's text file by hand, from National Instruments' specification. Its own reader is not at hand; lvm_read 1.26 finds the same numbers in them.
def write_lvm(name, times, separator, decimal, end):
    word = {"\t": "Tab", ",": "Comma"}[separator]
    channels = (("LVDT top", "mm", z), ("A1", "g", az), ("Force", "kN", fz))
    rows = [["LabVIEW Measurement"], ["Writer_Version", "2"], ["Reader_Version", "2"], ["Separator", word],
            ["Decimal_Separator", decimal], ["Multi_Headings", "No"], ["X_Columns", times], ["Time_Pref", "Absolute"],
            ["Operator", "nobody"], ["Date", "2024/06/07"], ["Time", f"10:45:47{decimal}0352557312499836422"],
            ["***End_of_Header***"], []]

    def for_each(key, texts):  # a field for each channel, and one for each time where every channel has its own
        gap = [""] if times == "Multi" else []
        rows.append([key] + [field for i, text in enumerate(texts) for field in (gap if i else []) + [text]])

    rows.append(["Channels", "3"])
    for_each("Samples", ["32"] * 3)
    for_each("Y_Unit_Label", [unit for _, unit, _ in channels])
    for_each("X_Dimension", ["Time"] * 3)
    for_each("X0", [f"0{decimal}0000000000000000E+0"] * 3)
    for_each("Delta_X", [f"0{decimal}001000"] * 3)
    rows.append(["***End_of_Header***"])
    for_each("X_Value", [title for title, _, _ in channels])
    if times == "Multi":
        rows[-1] = [field if field else "X_Value" for field in rows[-1]]
    rows[-1].append("Comment")
    for i in range(32):
        stamp = {"No": "", "One": f"{time[i]:.6f}", "Multi": f"{time[i]:.6f}"}[times]
        row = [stamp]
        for j, (_, _, values) in enumerate(channels):
            row += ([stamp] if j and times == "Multi" else []) + [f"{values[i]:.6f}"]
        rows.append([field.replace(".", decimal) for field in row] + (["looked at"] if i == 7 else []))
    width = len(rows[-1])  # of a row without comment
    for row in rows[rows.index(["Channels", "3"]):]:
        if row[0].startswith(("Channels", "Samples", "Y_Unit", "X_Dim", "X0", "Delta", "***")):
            row += [""] * (width + 1 - len(row))
    with open(folder / name, "w", newline="") as file:
        file.write("".join(separator.join(row) + end for row in rows))


write_lvm("labview_no_times.lvm", "No", "\t", ",", "\r\n")
write_lvm("labview_one_time.lvm", "One", ",", ".", "\n")
write_lvm("labview_each_time.lvm", "Multi", "\t", ".", "\r\n")
