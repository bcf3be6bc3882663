#include "identify/fit/stored_equations.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>

#include "identify/fit/intervals.hpp"
#include "identify/fit/slow_offset.hpp"
#include "models/common/error.hpp"
#include "models/common/text_file.hpp"

namespace wems::identify {

namespace {

/// Width of the test function: displacements alone need more smoothing since their second derivative is taken.
int chooseKnotSamples(const RunMotion& run, const FitOptions& options) {
    constexpr double with_accelerations = 0.5e-3, without = 2.5e-3;  // s
    const double time = options.knot_time > 0              ? options.knot_time
                        : run.mobile.acceleration_measured ? with_accelerations
                                                           : without;
    return std::max(1, static_cast<int>(std::lround(time / run.interval)));
}

}  // namespace

RunEquations makeRunEquations(const RunMotion& run, const MountModel& model, const FitOptions& options) {
    const TestFunction test_function(chooseKnotSamples(run, options), run.interval);
    if (test_function.outputCount(static_cast<int>(run.time.size())) < 50)
        throw InputError({run.file, 0, ""}, "too short for a fit: " + std::to_string(run.time.size()) + " samples",
                         "at least " + std::to_string(50 * test_function.stride() + 2 * test_function.half()));
    return makeEquations(run, model, test_function, !options.free_body.empty());
}

namespace {

constexpr std::string_view kMark = "WEMS equations 2\n";

/// Values one after the other; what has a size of its own is preceded by it.
class ByteWriter {
public:
    template <typename Value>
    void operator()(const Value& value) {
        static_assert(std::is_arithmetic_v<Value> || std::is_enum_v<Value>);
        put(&value, sizeof value);
    }
    void operator()(const std::string& text) {
        (*this)(text.size());
        put(text.data(), text.size());
    }
    template <typename Value>
    void operator()(const std::vector<Value>& values) {
        (*this)(values.size());
        for (const Value& value : values) (*this)(value);
    }
    template <typename Scalar, int Rows, int Columns, int Options>
    void operator()(const Eigen::Matrix<Scalar, Rows, Columns, Options>& matrix) {
        (*this)(matrix.rows());
        (*this)(matrix.cols());
        put(matrix.data(), sizeof(Scalar) * static_cast<std::size_t>(matrix.size()));
    }
    const std::string& bytes() const { return bytes_; }

private:
    void put(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

    std::string bytes_;
};

/// The same backwards. @throws InputError where the file ends too soon or a size makes no sense
class ByteReader {
public:
    ByteReader(std::string_view bytes, std::string file) : rest_(bytes), file_(std::move(file)) {}

    template <typename Value>
    void operator()(Value& value) {
        static_assert(std::is_arithmetic_v<Value> || std::is_enum_v<Value>);
        get(&value, sizeof value);
    }
    void operator()(std::string& text) {
        text.resize(getCount(1));
        get(text.data(), text.size());
    }
    template <typename Value>
    void operator()(std::vector<Value>& values) {
        values.resize(getCount(1));
        for (Value& value : values) (*this)(value);
    }
    template <typename Scalar, int Rows, int Columns, int Options>
    void operator()(Eigen::Matrix<Scalar, Rows, Columns, Options>& matrix) {
        Eigen::Index rows = 0, columns = 0;
        (*this)(rows);
        (*this)(columns);
        const Eigen::Index most = rest_.size() / sizeof(Scalar);
        if (rows < 0 || columns < 0 || (Rows != Eigen::Dynamic && rows != Rows) ||
            (Columns != Eigen::Dynamic && columns != Columns) || (columns > 0 && rows > most / columns))
            fail();
        matrix.resize(rows, columns);
        get(matrix.data(), sizeof(Scalar) * static_cast<std::size_t>(matrix.size()));
    }
    bool atEnd() const { return rest_.empty(); }
    [[noreturn]] void fail() const {
        throw InputError({file_, 0, ""}, "damaged, or not the equations of a run",
                         "a file that identify equations of this version wrote");
    }

private:
    std::size_t getCount(std::size_t least_size) {
        std::size_t count = 0;
        (*this)(count);
        if (count > rest_.size() / least_size) fail();
        return count;
    }
    void get(void* data, std::size_t size) {
        if (size > rest_.size()) fail();
        if (size > 0) std::memcpy(data, rest_.data(), size);
        rest_.remove_prefix(size);
    }

    std::string_view rest_;
    std::string file_;
};

// One list of members for both ways: `Transfer` is a ByteWriter with constant objects or a ByteReader with others.

template <typename Transfer, typename Channels>
void transferCalibration(Transfer& transfer, Channels& calibration) {
    transfer(calibration.channels);
    transfer(calibration.design);
    transfer(calibration.gain_scatter);
}

void transferDensity(ByteWriter& writer, const NoiseDensity& density) {
    writer(density.resolution());
    writer(density.variances());
    writer(density.finerResolution());
    writer(density.finerVariances());
}

NoiseDensity readDensity(ByteReader& reader) {
    double resolution = 0;
    std::vector<double> variances;
    reader(resolution);
    reader(variances);
    return {resolution, std::move(variances)};
}

void transferDensity(ByteReader& reader, NoiseDensity& density) {
    density = readDensity(reader);
    const NoiseDensity finer = readDensity(reader);
    const bool refined = !finer.variances().empty();
    if (!(density.resolution() > 0) || density.variances().empty() || (refined && !(finer.resolution() > 0)))
        reader.fail();
    if (refined) density.refine(finer);
}

template <typename Transfer, typename Part>
void transferPart(Transfer& transfer, Part& part) {
    for (auto* samples : {&part.p, &part.theta, &part.v, &part.w, &part.a, &part.alpha}) transfer(*samples);
    transfer(part.displacement_measured);
    transfer(part.acceleration_measured);
    transfer(part.displacement_noise);
    transfer(part.acceleration_noise);
    transferDensity(transfer, part.displacement_density);
    transferDensity(transfer, part.acceleration_density);
    transfer(part.fusion_weights);
    transferCalibration(transfer, part.displacement_calibration);
    transferCalibration(transfer, part.acceleration_calibration);
    transfer(part.displacement_covariance);
    transfer(part.acceleration_covariance);
}

template <typename Transfer, typename Motion>
void transferMotion(Transfer& transfer, Motion& motion) {
    transfer(motion.file);
    transfer(motion.time);
    transfer(motion.interval);
    transferPart(transfer, motion.mobile);
    transferPart(transfer, motion.fixed);
    transfer(motion.fixed_source);
    for (auto* frequency :
         {&motion.trusted_from, &motion.mobile_trusted_from, &motion.fixed_trusted_from, &motion.trusted_to})
        transfer(*frequency);
    transfer(motion.notes);
}

template <typename Transfer, typename Equations>
void transferEquations(Transfer& transfer, Equations& equations) {
    transfer(equations.layout.axes);
    transfer(equations.layout.free_body);
    transfer(equations.outputs);
    transfer(equations.columns);
    for (auto& axis : equations.axes) {
        transfer(axis.sample);
        transfer(axis.q);
        transfer(axis.v);
        transfer(axis.pattern);
        transfer(axis.largest);
        transfer(axis.smallest);
    }
}

bool isConsistent(const StoredRun& run, const MountModel& model) {
    const RunEquations& equations = run.equations;
    bool right = !run.motion.time.empty() && equations.outputs > 0 &&
                 equations.layout.axes == 3 * static_cast<int>(model.connections.size()) &&
                 equations.columns.rows() == 6L * equations.outputs &&
                 equations.columns.cols() == equations.layout.count();
    for (const AxisHistory& axis : equations.axes)
        right = right && axis.q.size() == axis.sample.size() && axis.v.size() == axis.sample.size() &&
                axis.pattern.cols() == static_cast<Eigen::Index>(axis.sample.size());
    return right;
}

}  // namespace

StoredRun makeStoredRun(RunMotion motion, const MountModel& model, const FitOptions& options) {
    if (lacksSlowMotion(motion))
        throw InputError({motion.file, 0, ""}, "accelerations alone: their slow motion follows from all runs together",
                         "runs with displacements; identify fit takes accelerations alone");
    RunEquations equations = makeRunEquations(motion, model, options);
    motion.load.resize(3, 0);
    motion.base.resize(3, 0);
    motion.base_displacement.resize(3, 0);
    return {std::move(motion), std::move(equations)};
}

void writeStoredRun(const StoredRun& run, const MountModel& model, const FitOptions& options, const std::string& file,
                    OutputFiles& outputs) {
    ByteWriter writer;
    writer(std::string(kMark));
    writer(formatMountModel(model, model.bracket_file));
    writer(options.free_body);
    writer(options.knot_time);
    writer(run.equations.test_function.knotSamples());
    transferMotion(writer, run.motion);
    transferEquations(writer, run.equations);
    outputs.add(file, writer.bytes());
}

StoredRun readStoredRun(const std::string& file, const MountModel& model, const FitOptions& options) {
    const TextFile stored(file);
    ByteReader reader(stored.view(), file);
    std::string mark, model_text;
    reader(mark);
    if (mark != kMark) reader.fail();
    FitOptions made_with;
    reader(model_text);
    reader(made_with.free_body);
    reader(made_with.knot_time);
    if (model_text != formatMountModel(model, model.bracket_file))
        throw InputError({file, 0, ""}, "its equations were made with another model", "those of this model");
    if (made_with.free_body != options.free_body || made_with.knot_time != options.knot_time)
        throw InputError({file, 0, ""}, "its equations were made with another --free", "the same in all commands");
    int knot_samples = 0;
    reader(knot_samples);
    RunMotion motion;
    transferMotion(reader, motion);
    if (knot_samples < 1 || !(motion.interval > 0)) reader.fail();
    RunEquations equations{{}, TestFunction(knot_samples, motion.interval), 0, {}, {}};
    equations.axes.resize(3 * model.connections.size());
    transferEquations(reader, equations);
    StoredRun run{std::move(motion), std::move(equations)};
    if (!reader.atEnd() || !isConsistent(run, model)) reader.fail();
    return run;
}

}  // namespace wems::identify
