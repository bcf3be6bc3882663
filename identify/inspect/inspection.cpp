#include "identify/inspect/inspection.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "identify/forward/relative_displacement.hpp"
#include "identify/inspect/connection_checks.hpp"
#include "identify/inspect/order_tracking.hpp"
#include "identify/inspect/slow_defects.hpp"
#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "identify/motion/rigidity.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {

void BlockNotes::add(const std::string& note) {
    std::string kind = note;
    kind.erase(std::remove_if(kind.begin(), kind.end(),
                              [](unsigned char c) { return std::isdigit(c) != 0 || c == '.' || c == '+' || c == '-'; }),
               kind.end());
    const auto [place, is_new] = index_.try_emplace(kind, notes_.size());
    if (is_new) notes_.push_back({note, 0});
    ++notes_[place->second].blocks;
}

std::vector<std::string> BlockNotes::list() const {
    std::vector<std::string> texts;
    for (const Note& note : notes_)
        texts.push_back(note.blocks == 1
                            ? note.text
                            : note.text + " (and the like in " + std::to_string(note.blocks - 1) + " more blocks)");
    return texts;
}

namespace {

bool has(const Recording& recording, Part part) {
    return std::any_of(recording.channels.begin(), recording.channels.end(), [part](const Channel& channel) {
        const auto name = parseChannelName(channel.name);
        return name && name->part == part;
    });
}

const char* describe(Derivative derivative) {
    switch (derivative) {
        case Derivative::displacement:
            return "displacement";
        case Derivative::velocity:
            return "velocity";
        case Derivative::acceleration:
            return "acceleration";
        case Derivative::force:
            break;
    }
    return "force";
}

void describePart(const Recording& recording, const MountModel* model, Part part, std::vector<std::string>& lines) {
    const std::string name = part == Part::mobile ? "mobile part" : "fixed part";
    for (const auto derivative : {Derivative::displacement, Derivative::velocity, Derivative::acceleration}) {
        const auto count = std::count_if(recording.channels.begin(), recording.channels.end(), [&](const Channel& c) {
            const auto parsed = parseChannelName(c.name);
            return parsed && parsed->part == part && parsed->derivative == derivative;
        });
        if (count == 0) continue;
        std::string line = name + ": " + std::to_string(count) + " " + describe(derivative) + " channels";
        if (model != nullptr) {
            try {
                const RigidFit fit(collectChannels(recording, *model, part, derivative), BodyMotion{});
                line += fit.undetermined().empty()
                            ? ", which determine all six motions" +
                                  (fit.redundancy() > 0 ? " with " + std::to_string(fit.redundancy()) + " to spare"
                                                        : std::string(", none to spare: no fault of a channel shows"))
                            : ", which leave open its " + joinWords(fit.undetermined());
            } catch (const InputError& error) {
                line += ": " + error.problem();
            }
        }
        lines.push_back(line);
    }
}

void describeComponents(const Recording& recording, std::vector<std::string>& lines) {
    const auto forces = recording.connections(Part::force);
    for (const auto& connection : recording.connections(Part::relative)) {
        const bool force = std::find(forces.begin(), forces.end(), connection) != forces.end();
        lines.push_back("element " + connection +
                        (force ? ": force and motion measured: its law can be fitted directly (fit, surface)"
                               : ": no force.* channel, so that its law cannot be told from this recording"));
    }
}

void describeStops(const MountModel& model, const std::vector<bool>& is_reached, std::vector<std::string>& lines) {
    std::vector<std::string> reached, missed;
    std::size_t next = 0;
    for (const Connection& connection : model.connections) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (const Stop& stop : connection.axis.at(axis).stops) {
                const std::string name =
                    connection.name + "." + static_cast<char>('x' + axis) + (stop.side == Side::positive ? ".+" : ".-");
                (is_reached.at(next++) ? reached : missed).push_back(name);
            }
        }
    }
    if (!reached.empty()) lines.push_back("stops reached with the model's clearances: " + joinWords(reached));
    if (!missed.empty())
        lines.push_back("stops not reached, so that nothing can be said of them: " + joinWords(missed));
}

}  // namespace

std::vector<bool> findReachedStops(const Recording& recording, const MountModel& model) {
    RelativeDisplacement relative;
    try {
        relative = calcRelativeDisplacement(recording, model);
    } catch (const InputError&) {
        return {};
    }
    std::vector<bool> reached;
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const AxisLaw& law = model.connections[i].axis.at(axis);
            const Eigen::RowVectorXd q = relative.q.row(3 * i + axis).array() + law.offset;  // from mid-gap
            for (const Stop& stop : law.stops)
                reached.push_back((stop.side == Side::positive ? q.maxCoeff() : -q.minCoeff()) > stop.clearance);
        }
    }
    return reached;
}

std::vector<std::string> describeAbilities(const Recording& recording, const MountModel* model,
                                           const std::vector<bool>& reached) {
    std::vector<std::string> lines;
    const bool component = has(recording, Part::relative) || has(recording, Part::force);
    if (has(recording, Part::load)) {
        lines.emplace_back("drive: the load is recorded and is used as it was, not as commanded");
    } else if (has(recording, Part::base)) {
        lines.emplace_back("drive: the base's motion is recorded; forces follow from the mass of the mobile part");
    } else if (!component) {
        lines.emplace_back(
            "drive: neither load nor base is recorded; simulations are driven by the fixed part's motion, and forces "
            "follow from the mass of the mobile part");
    }
    describePart(recording, model, Part::mobile, lines);
    describePart(recording, model, Part::fixed, lines);
    if (component) describeComponents(recording, lines);
    if (model != nullptr && !reached.empty()) describeStops(*model, reached, lines);
    if (!has(recording, Part::mobile) && !component)
        lines.emplace_back("no channel of the mobile part and none of a component test: nothing can be identified");
    return lines;
}

namespace {

constexpr std::size_t least_samples = 64;

/// What has to be there most of the time.
bool isLasting(FindingKind kind) {
    return kind == FindingKind::offset || kind == FindingKind::drift || kind == FindingKind::hum;
}

}  // namespace

std::vector<Finding> findDefects(const Recording& recording, const SweptFrequency& swept) {
    std::vector<Finding> findings = recording.findings;
    if (recording.sampleCount() < least_samples) return findings;
    const double interval = recording.sampleInterval();
    for (const Channel& channel : recording.channels) {
        const Eigen::Map<const Eigen::VectorXd> signal(channel.values.data(), channel.values.size());
        const double noise = estimateNoiseFromSignal(signal);
        const bool clipped = std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
            return finding.kind == FindingKind::clipped && finding.channel == channel.name;
        });
        for (Finding& finding : findPlateaus(channel, recording.time, noise, recording.first_row)) {
            // One limit, one finding.
            if (finding.kind == FindingKind::saturated && clipped) continue;
            findings.push_back(std::move(finding));
        }
        const bool limited = std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
            return finding.channel == channel.name &&
                   (finding.kind == FindingKind::clipped || finding.kind == FindingKind::saturated);
        });
        for (Finding& finding : findSlowDefects(channel, interval, noise, swept, recording.time, recording.first_row)) {
            // What is cut off on one side shifts the mean: one fault, one finding.
            if (finding.kind == FindingKind::offset && limited) continue;
            findings.push_back(std::move(finding));
        }
    }
    return findings;
}

void Inspector::addDrive(const SweptFrequency& swept) {
    if (blocks_ == 0) swept_ = swept;
    if (swept.is_sine) ++sine_blocks_;
    if (!swept.tones.empty()) ++tone_blocks_;
    if (swept_.tones.empty()) swept_.tones = swept.tones;
    if (swept_.source.empty()) swept_.source = swept.source;
    if (!(swept.lowest > 0)) return;
    swept_.lowest = swept_.lowest > 0 ? std::min(swept_.lowest, swept.lowest) : swept.lowest;
    swept_.highest = std::max(swept_.highest, swept.highest);
}

void Inspector::addWithModel(const Recording& block, std::vector<Finding>& findings) {
    for (Finding& finding : checkAgainstModel(block, *model_)) findings.push_back(std::move(finding));
    try {
        for (const ChannelSuspect& suspect : checkRigidity(block, *model_).suspects) {
            notes_.add(suspect.channel + " does not move as the rigid part does: " + suspect.fault +
                       (suspect.exchanged_with.empty() ? "" : " with " + suspect.exchanged_with) +
                       "; `identify rigidity` says more");
        }
    } catch (const InputError& error) {
        notes_.add("rigidity is not checked: " + error.problem());
    }
    const std::vector<bool> reached = findReachedStops(block, *model_);
    reached_.resize(std::max(reached_.size(), reached.size()), false);
    for (std::size_t i = 0; i < reached.size(); ++i) reached_[i] = reached_[i] || reached[i];
}

void Inspector::addFindings(const std::vector<Finding>& findings) {
    const auto known = found_.size();  // one block may hold several of a kind, each in its own right
    for (const Finding& finding : findings) {
        const auto end = found_.begin() + static_cast<std::ptrdiff_t>(known);
        const auto same = std::find_if(found_.begin(), end, [&](const Found& found) {
            return found.first.kind == finding.kind && found.first.channel == finding.channel;
        });
        if (same == end) {
            found_.push_back({finding, 1});
        } else {
            ++same->blocks;
        }
    }
}

void Inspector::add(const Recording& block) {
    std::vector<std::string> notes;
    Recording uniform = block;
    if (block.sampleCount() >= least_samples) uniform = makeUniform(block, notes);
    for (const auto& note : notes) notes_.add(note);
    if (blocks_ == 0) {
        names_ = block;
        names_.time.clear();
        for (Channel& channel : names_.channels) channel.values.clear();
        first_time_ = block.time.front();
        levels_.resize(block.channels.size());
    }
    last_time_ = block.time.back();
    for (std::size_t c = 0; c < levels_.size(); ++c) levels_[c].add(uniform.channels[c], uniform.sampleInterval());
    const SweptFrequency swept = findSweptFrequency(uniform);
    addDrive(swept);
    OrderTracking orders = trackOrders(uniform, swept);
    envelope_.add(orders);
    if (blocks_ == 0) orders_ = std::move(orders);
    std::vector<Finding> findings = findDefects(block, swept);
    if (model_ != nullptr) addWithModel(block, findings);
    addFindings(findings);
    samples_ += block.sampleCount() - (blocks_ > 0 ? 1 : 0);
    ++blocks_;
}

std::vector<Finding> Inspector::listFindings() const {
    std::vector<Finding> findings;
    for (const Found& found : found_) {
        if (isLasting(found.first.kind) && 2 * found.blocks < blocks_) continue;
        findings.push_back(found.first);
        if (blocks_ > 1)
            findings.back().message +=
                " (the first of " + std::to_string(found.blocks) + " among " + std::to_string(blocks_) + " blocks)";
    }
    std::stable_sort(findings.begin(), findings.end(),
                     [](const Finding& a, const Finding& b) { return a.row < b.row; });
    return findings;
}

Inspection Inspector::finish() {
    if (blocks_ == 0) throw InputError({}, "there is no sample to inspect");
    Inspection inspection;
    inspection.samples = samples_;
    inspection.blocks = blocks_;
    inspection.duration = last_time_ - first_time_;
    inspection.rate = inspection.duration > 0 ? static_cast<double>(samples_ - 1) / inspection.duration : 0;
    for (const ChannelLevels& levels : levels_) inspection.channels.push_back(levels.finish());
    inspection.swept = std::move(swept_);
    if (blocks_ > 1) {
        inspection.swept.hertz.resize(0);
        inspection.swept.is_sine = 2 * sine_blocks_ > blocks_;
        if (2 * tone_blocks_ <= blocks_) inspection.swept.tones.clear();
    }
    inspection.orders = blocks_ > 1 ? envelope_.finish() : std::move(orders_);
    inspection.findings = listFindings();
    inspection.abilities = describeAbilities(names_, model_, reached_);
    inspection.notes = notes_.list();
    if (blocks_ > 1) inspection.quality = judgeFindings(inspection.findings);
    return inspection;
}

Inspection inspect(const Recording& recording, const MountModel* model) {
    Inspector inspector(model);
    inspector.add(recording);
    Inspection inspection = inspector.finish();
    inspection.quality = judgeQuality(recording, model, inspection.findings);
    return inspection;
}

}  // namespace wems::identify
