#include "identify/commands/fitted_model.hpp"

#include "models/error.hpp"

namespace wems::identify::commands {

void addFittedModel(const MountModel& fitted, const std::string& file, OutputFiles& outputs) {
    try {
        writeMountModel(fitted, file, outputs);
    } catch (const InputError& error) {
        if (!error.location().file.empty()) throw;
        throw InputError({file, 0, error.location().key},
                         "the fitted value makes no model that could be read again: it " + error.problem(),
                         error.accepted());
    }
}

}  // namespace wems::identify::commands
