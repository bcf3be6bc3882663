// simulate_beam: the clamped-free beam with a cubic spring at its tip, recorded as CSV.
#include <CLI/CLI.hpp>
#include <iostream>

#include "models/beam/beam.hpp"
#include "models/common/error.hpp"
#include "models/recording/recording_writer.hpp"

int main(int argc, char** argv) {
    wems::Beam beam;
    wems::BeamRun run;
    run.force = 10;
    double from = 10, to = 60, rate = 16;
    std::string output;
    CLI::App app{
        "Simulate a clamped-free beam (0.7 m x 14 mm x 14 mm, steel, ten elements) with a cubic spring at its tip "
        "under a sweep of the force at its third node."};
    app.name("simulate_beam");
    app.add_option("-o,--output", output, "recording to write, CSV")->required();
    app.add_option("--force", run.force, "N (default 10)");
    app.add_option("--from", from, "Hz, start of the sweep (default 10)");
    app.add_option("--to", to, "Hz, end of the sweep (default 60)");
    app.add_option("--rate", rate, "octaves per minute (default 16)");
    app.add_option("--cubic", beam.tip_cubic, "N/m^3, of the tip spring (default 8e9)");
    app.footer("Example:\n  simulate_beam --force 10 -o beam.csv");
    try {
        app.parse(argc, argv);
        wems::writeCsv(simulateBeam(beam, *wems::makeLogarithmicSweep(from, to, rate), run), output, 13);
        std::cout << "natural frequencies without the spring: " << wems::findBeamFrequencies(beam).head<4>().transpose()
                  << " Hz\n";
        return 0;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        std::cerr << "simulate_beam: " << error.what() << "\n";
    }
    return 2;
}
