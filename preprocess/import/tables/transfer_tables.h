// Members of notes and of structures, for archives.
#pragma once

#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

void transfer(auto& archive, Term& term) {
  archive(term.vocabulary, term.value);
}
void transfer(auto& archive, SourceStructure& structure) {
  archive(structure.name, structure.label, structure.code, structure.color, structure.external,
          structure.terms);
}
void transfer(auto& archive, Note& note) {
  archive(note.kind, note.items);
}
}  // namespace splatlas
