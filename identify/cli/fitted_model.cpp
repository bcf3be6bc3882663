#include "identify/cli/fitted_model.hpp"

#include "models/admissible_model.hpp"
#include "models/error.hpp"

namespace wems::identify::cli {

void addFittedModel(const MountModel& believed, MountModel fitted, const std::string& file,
                    std::vector<std::string>& notes, OutputFiles& outputs) {
    for (std::string& note : makeAdmissible(believed, fitted)) notes.push_back(std::move(note));
    try {
        writeMountModel(fitted, file, outputs);
    } catch (const InputError& error) {
        if (!error.location().file.empty()) throw;
        throw InputError({file, 0, error.location().key},
                         "the fitted value makes no model that could be read again: it " + error.problem(),
                         error.accepted());
    }
}

}  // namespace wems::identify::cli
