# The files that the documents' commands read and do not make themselves: three short runs of the shipped device, a model that
# is wrong, and what the other names stand for. Everything is written into the working folder.
model=models/shipped/smallsat_wems.toml
sweep() { simulate $model --sweep 5:50 --rate 60 --noise displacement=1e-6,acceleration=0.01 -q "$@"; }
sweep --force z=300 -o run1.csv
sweep --force x=150,y=200 --seed 2 -o run2.csv
sweep --force x=100,z=250 --seed 3 -o run3.csv
sed 's/stiffness = 1.0e5/stiffness = 0.8e5/; s/modes = "/modes = "models\/shipped\//' $model > believed.toml
cp believed.toml mount.toml

# Two recordings of one test: load, accelerations and one displacement, and the cameras' positions of everything.
python3 - <<'END'
import csv
rows = list(csv.reader(line for line in open("run1.csv") if not line.startswith("#")))
kept = [i for i, name in enumerate(rows[0])
        if name.startswith(("time", "load.", "fixed.1.z ")) or name.split(" ")[0].split(".")[-1] in ("ax", "ay", "az")]
csv.writer(open("shaker.csv", "w", newline="")).writerows([[row[i] for i in kept] for row in rows])
END
identify convert run1.csv cameras.trc -q

# One element on a test machine, and functions in a universal file.
python3 - <<'END'
import math
with open("component_test.csv", "w") as file:
    file.write("t [ms],travel [mm],load cell [kN]\n")
    for k in range(4000):
        q = 2 * math.sin(0.0314 * k) * (1 + k / 4000)
        file.write(f"{k},{q:.6f},{0.05 * q + 0.4 * max(0, q - 1.5) + 1e-4 * math.sin(7.1 * k):.7f}\n")
END
printf '[columns]\n"t" = "time"\n"travel" = "relative.1.z"\n"load cell" = "force.1.z"\n' > element.toml
cp tests/recording/data/pyuff_ascii.uff run.uff
printf '[columns]\n"12:+Z" = "mobile.1.z"\n"1:+Z" = "load.fz"\n' > nodes.toml

# A test of two runs in which a camera saw connection 1 under a name of its own.
for run in axial=run1 oblique=run2; do
  sed 's/mobile\.1\.\([xyz]\) /P1 \1 /g' "${run#*=}.csv" > "${run%=*}.csv"
done
cat > layout.toml <<'END'
[[marker]]
name = "P1"
part = "mobile"
position = [-0.1, 0.0, 0.0]
channels = { x = "P1 x", y = "P1 y", z = "P1 z" }
END
cat > campaign.toml <<'END'
model = "believed.toml"
[[run]]
file = "axial.csv"
role = "identify"
[[run]]
file = "oblique.csv"
role = "validate"
END
