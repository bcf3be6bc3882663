#include "models/sensor_place.hpp"

#include <algorithm>

#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/sensor_place_toml.hpp"

namespace wems {

Eigen::Vector3d SensorPlace::direction(int axis) const {
    return rotationFromVector(rotation) * Eigen::Vector3d::Unit(axis);
}

std::string SensorPlace::channelName(int axis) const {
    return formatChannelName({part, name, axis, accelerometer ? Derivative::acceleration : Derivative::displacement});
}

void readSensorTables(TomlTable& root, std::vector<SensorPlace>& places) {
    for (const bool accelerometer : {false, true}) {
        root.readTables(accelerometer ? "accelerometer" : "marker", [&](TomlTable& table) {
            SensorPlace place;
            place.accelerometer = accelerometer;
            place.name = table.requireString("name", "a name without points");
            if (place.name.empty() || place.name.find('.') != std::string::npos)
                table.fail("name", "is \"" + place.name + "\"", "a name without points");
            const std::string part = table.requireString("part", "mobile, fixed");
            if (part != "mobile" && part != "fixed") table.fail("part", "is \"" + part + "\"", "mobile, fixed");
            place.part = part == "mobile" ? Part::mobile : Part::fixed;
            place.position = table.requireVector("position", "m");
            place.rotation = table.findVector("rotation").value_or(Eigen::Vector3d::Zero());
            place.noise = table.findNumber("noise").value_or(0);
            if (place.noise < 0) table.fail("noise", "is negative", "the RMS of one channel, above 0");
            table.readTable("channels", [&](TomlTable& channels) {
                for (std::size_t k = 0; k < 3; ++k)
                    place.columns.at(k) = channels.findString(std::string(1, "xyz"[k])).value_or("");
            });
            const bool twice = std::any_of(places.begin(), places.end(), [&](const SensorPlace& other) {
                return other.name == place.name && other.part == place.part &&
                       other.accelerometer == place.accelerometer;
            });
            if (twice) table.fail("name", "\"" + place.name + "\" stands twice", "a name of its own");
            places.push_back(std::move(place));
        });
    }
}

std::vector<SensorPlace> readSensorPlaces(const std::string& file) {
    std::vector<SensorPlace> places;
    readTomlFile(file, [&places](TomlTable& root) { readSensorTables(root, places); });
    if (places.empty()) throw InputError({file, 0, {}}, "there is no [[marker]] and no [[accelerometer]]");
    return places;
}

void addColumns(const std::vector<SensorPlace>& places, ColumnMap& map) {
    for (const SensorPlace& place : places) {
        for (int axis = 0; axis < 3; ++axis) {
            const std::string& column = place.columns.at(axis);
            if (column.empty()) continue;
            const std::string channel = place.channelName(axis);
            const bool taken = std::any_of(map.columns.begin(), map.columns.end(),
                                           [&](const MappedColumn& other) { return other.channel == channel; });
            if (taken)
                throw InputError({map.file, 0, channel}, "is given by the column map and by the geometry",
                                 "one of them");
            MappedColumn mapped;
            mapped.column = column;
            mapped.channel = channel;
            map.columns.push_back(std::move(mapped));
        }
    }
}

}  // namespace wems
