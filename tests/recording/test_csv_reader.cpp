#include <catch2/catch.hpp>

#include "models/recording/csv_reader.hpp"
#include "models/recording/recording_reader.hpp"
#include "tests/recording/temporary_file.hpp"

using namespace wems;

namespace {

const std::string header = "time [s],mobile.1.x [mm],load.fz [kN]\n";

void checkValues(const Recording& recording) {
    REQUIRE(recording.time == std::vector<double>{0, 0.5, 1});
    REQUIRE(recording.channels.size() == 2);
    CHECK(recording.channels[0].name == "mobile.1.x");
    CHECK(recording.channels[0].values[1] == Approx(-1.25e-3).epsilon(1e-14));
    CHECK(recording.channels[0].values[2] == Approx(2e-3).epsilon(1e-14));
    CHECK(recording.channels[1].values[0] == Approx(1500).epsilon(1e-14));
}

}  // namespace

TEST_CASE("Every dialect of the same table gives the same recording") {
    const auto* text = GENERATE(
        "time [s],mobile.1.x [mm],load.fz [kN]\n0,0.5,1.5\n0.5,-1.25,0\n1,2,-1\n",
        "time [s],mobile.1.x [mm],load.fz [kN]\r\n0,0.5,1.5\r\n0.5,-1.25,0\r\n1,2,-1\r\n",
        "\xEF\xBB\xBFtime [s],mobile.1.x [mm],load.fz [kN]\n0,0.5,1.5\n0.5,-1.25,0\n1,2,-1",
        "time [s];mobile.1.x [mm];load.fz [kN]\n0;0,5;1,5\n0,5;-1,25;0\n1;2;-1\n",
        "time [s];mobile.1.x [mm];load.fz [kN]\n0;0.5;1.5\n0.5;-1.25;0\n1;2;-1\n",
        "time [s]\tmobile.1.x [mm]\tload.fz [kN]\n0\t0,5\t1,5\n0,5\t-1,25\t0\n1\t2\t-1\n",
        "\"time [s]\",\"mobile.1.x [mm]\",\"load.fz [kN]\"\n\"0\",\"0.5\",\"1.5\"\n\"0.5\",\"-1.25\",0\n1,2,\"-1\"\n",
        "\"time [s]\",\"mobile.1.x [mm]\",\"load.fz [kN]\"\n0,\"0,5\",\"1,5\"\n\"0,5\",\"-1,25\",0\n1,2,\"-1\"\n",
        "time [s],mobile.1.x [mm],load.fz [kN],,\n0,0.5,1.5,,\n0.5,-1.25,0,,\n1,2,-1,\n,,,,\n\n  \n",
        " time [s] , mobile.1.x [ mm ] , load.fz[kN]\n 0 , 0.5 , 1.5 \n+0.5,-1.250,0e0\n1,+2.0E0,-1 \n\r\n\r\n",
        "# test: a run\n\n# a remark\ntime [ms],mobile.1.x [m],load.fz "
        "[N]\n0,5e-4,1500\n500,-0.00125,0\n1e3,2e-3,-1e3\n");
    INFO(text);
    const auto recording = parseRecording(text, "run.csv");
    checkValues(recording);
    CHECK(recording.warnings.empty());
}

TEST_CASE("Spreadsheets' UTF-16, of either byte order") {
    const std::string plain = "time [s]\tmobile.1.x [mm]\tload.fz [kN]\r\n0\t0,5\t1,5\r\n0,5\t-1,25\t0\r\n1\t2\t-1\r\n";
    for (const bool little : {true, false}) {
        std::string text = little ? "\xFF\xFE" : "\xFE\xFF";
        for (const char c : plain) {
            if (!little) text += '\0';
            text += c;
            if (little) text += '\0';
        }
        checkValues(parseRecording(text, "run.csv"));
    }
}

TEST_CASE("Columns between, before and after the channels are skipped, whatever they hold") {
    const auto recording = parseRecording(
        "note,time [s],\"quoted, note\",mobile.1.x [mm],comment,load.fz [kN],last\n"
        "a,0,x,0.5,,1.5,z\nb,0.5,,-1.25,nothing,0,\nc,1,y,2,1e,-1,z z\n",
        "run.csv");
    checkValues(recording);
    CHECK(recording.unused_columns == std::vector<std::string>{"note", "quoted, note", "comment", "last"});
    CHECK(recording.channels[0].column == 4);
    CHECK(recording.channels[1].column == 6);
    CHECK(recording.channels[1].unit == "kN");
}

TEST_CASE("A few columns of many: the same values as of the whole") {
    const int columns = 300, rows = 50;
    std::string all = "time [s]", few = "time [s]", body;
    for (int j = 1; j < columns; ++j) {
        const std::string name = ",mobile." + std::to_string(j) + ".x [m]";
        all += name;
        few += j % 97 == 5 ? name : ",other " + std::to_string(j);
    }
    for (int i = 0; i < rows; ++i) {
        body += "\n" + std::to_string(i);
        for (int j = 1; j < columns; ++j) body += "," + std::to_string(i * 1000 + j) + (j % 3 == 0 ? ".5" : "");
    }
    const auto whole = parseRecording(all + body, "run.csv");
    const auto part = parseRecording(few + body + "\n", "run.csv");
    REQUIRE(part.channels.size() == 4);
    REQUIRE(part.sampleCount() == rows);
    for (const auto& channel : part.channels) {
        REQUIRE(whole.find(channel.name) != nullptr);
        CHECK(whole.find(channel.name)->values == channel.values);
        CHECK(channel.values[1] == 1000 + channel.column - 1 + ((channel.column - 1) % 3 == 0 ? 0.5 : 0.0));
    }
}

TEST_CASE("Metadata, first row and file are kept") {
    const test::TemporaryFile file("# test: sine sweep 5-50 Hz: axial\n#level:200 N\n# a remark\n" + header +
                                   "0,1,2\n1,2,3\n");
    const auto recording = readRecording(file.path());
    CHECK(recording.file == file.path());
    CHECK(recording.metadata ==
          std::map<std::string, std::string>{{"test", "sine sweep 5-50 Hz: axial"}, {"level", "200 N"}});
    CHECK(recording.first_row == 5);
    CHECK(recording.sampleCount() == 2);
}

TEST_CASE("The first row does not say how many there are") {
    std::string text = header;
    for (int i = 0; i < 5000; ++i) {
        text += std::to_string(i) + (i == 0 ? ",1.000000000000000000000000000000000000000000,2\n" : ",1,2\n");
    }
    const auto recording = parseRecording(text, "run.csv");
    REQUIRE(recording.sampleCount() == 5000);
    CHECK(recording.time[4999] == 4999);
    CHECK(recording.channels[1].values[4999] == 2000);
}

TEST_CASE("Only one row, only accelerations, only a component test") {
    CHECK(parseRecording("time [s],mobile.1.az [g]\n0,1\n", "a.csv").channels[0].values[0] == 9.80665);
    const auto component = parseRecording("time [s],relative.a.z [in],force.a.z [kip]\n0,1,1\n1,2,2\n", "a.csv");
    CHECK(component.channels[0].values[1] == Approx(0.0508));
    CHECK(component.channels[1].values[0] == Approx(4448.2216152605));
}
